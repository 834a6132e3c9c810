//! A range on the command line: `from:to:count`, or one value.

use std::str::FromStr;

/// Evenly spaced values, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    from: f64,
    to: f64,
    count: usize,
}

impl Span {
    /// One value.
    #[must_use]
    pub fn one(value: f64) -> Self {
        Self {
            from: value,
            to: value,
            count: 1,
        }
    }

    /// The values in order.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        match self.count {
            1 => vec![self.from],
            count => (0..count)
                .map(|index| match (index, count - 1 - index) {
                    (0, _) => self.from,
                    (_, 0) => self.to,
                    // One rounding, at the end: 5:60:23 has 7.5, not a neighbour of it.
                    (below, above) => {
                        (self.from * above as f64 + self.to * below as f64) / (count - 1) as f64
                    }
                })
                .collect(),
        }
    }

    /// Whether there is more than one value.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.count > 1
    }
}

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |part: &str| match part.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!(
                "`{part}` is not a finite number; give one, such as 55, or a range FROM:TO:COUNT, such as 20:80:13"
            )),
        };
        let parts: Vec<&str> = text.split(':').collect();
        match parts[..] {
            [value] => number(value).map(Self::one),
            [from, to, count] => {
                let (from, to) = (number(from)?, number(to)?);
                match count.trim().parse::<usize>() {
                    Ok(count) if (2..=100_000).contains(&count) && from != to => {
                        Ok(Self { from, to, count })
                    }
                    Ok(_) if from == to => Err(format!("both ends are {from}; a range needs two")),
                    _ => Err(format!(
                        "`{count}` is not a number of values from 2 to 100000"
                    )),
                }
            }
            _ => Err("from:to:count is needed, such as 5:60:56, or one value".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_include_both_ends() {
        let values = "5:60:56".parse::<Span>().unwrap().values();
        assert_eq!(
            (values.len(), values[0], values[50], values[55]),
            (56, 5.0, 55.0, 60.0)
        );
        assert_eq!("55".parse::<Span>().unwrap().values(), [55.0]);
        let halves = "5:60:23".parse::<Span>().unwrap().values();
        assert!(halves.iter().all(|value| (2.0 * value).fract() == 0.0));
        let falling = "0.3:0.1:3".parse::<Span>().unwrap().values();
        assert_eq!(falling, [0.3, 0.2, 0.1]);
        for wrong in [
            "", "1:2", "1:2:1", "1:1:5", "1:2:x", "a:2:5", "1:2:3:4", "inf",
        ] {
            assert!(wrong.parse::<Span>().is_err(), "{wrong}");
        }
    }
}
