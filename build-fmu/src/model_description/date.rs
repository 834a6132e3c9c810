//! The date of generation, if the builder is told one: the same model gives the same bytes on every day.

use thiserror::Error;

/// Environment variable with the seconds since 1970 that reproducible builds agree on
/// (<https://reproducible-builds.org/specs/source-date-epoch/>).
pub const SOURCE_DATE_EPOCH: &str = "SOURCE_DATE_EPOCH";

/// A date that is none.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "{SOURCE_DATE_EPOCH} is {0:?}; it must be a number of seconds since 1970-01-01, below 253402300800"
)]
pub struct DateError(pub String);

/// `generationDateAndTime` for the value of [`SOURCE_DATE_EPOCH`], if it is set.
///
/// # Errors
/// The value is no such number.
pub fn generation_date(epoch: Option<&str>) -> Result<Option<String>, DateError> {
    let Some(text) = epoch else {
        return Ok(None);
    };
    // To the end of the year 9999: four digits are all that the standards' XML has.
    let seconds = text
        .parse::<u64>()
        .ok()
        .filter(|seconds| *seconds < 253_402_300_800);
    let seconds = seconds.ok_or_else(|| DateError(text.to_owned()))?;
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let (year, month, day) = civil(days);
    let (hour, minute, second) = (rest / 3600, rest / 60 % 60, rest % 60);
    Ok(Some(format!(
        "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z"
    )))
}

/// Year, month and day of a day counted from 1970-01-01, by years that begin in March.
fn civil(days: u64) -> (u64, u64, u64) {
    // Days since 0000-03-01; 400 years have 146097 of them.
    let days = days + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    (era * 400 + year_of_era + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_become_dates() {
        for (seconds, date) in [
            ("0", "1970-01-01T00:00:00Z"),
            ("951782400", "2000-02-29T00:00:00Z"),
            ("1795564799", "2026-11-24T23:59:59Z"),
            ("4107542400", "2100-03-01T00:00:00Z"),
            ("253402300799", "9999-12-31T23:59:59Z"),
        ] {
            assert_eq!(
                generation_date(Some(seconds)).unwrap().as_deref(),
                Some(date)
            );
        }
        assert_eq!(generation_date(None), Ok(None));
    }

    #[test]
    fn what_is_no_number_of_seconds_is_refused() {
        for text in ["", "-1", "1.5", "yesterday", "253402300800"] {
            assert_eq!(generation_date(Some(text)), Err(DateError(text.to_owned())));
        }
    }
}
