//! Steps a component through its inputs and collects its outputs.

use anyhow::ensure;

use crate::component::{Component, Kind, Role};
use crate::files::record::Record;

use super::drive::Drive;

/// Times nearer than this [s] are the same.
pub(super) const SAME_TIME: f64 = 1e-9;

/// The times at which the result has rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    start: f64,
    step: f64,
    rows: usize,
}

impl Schedule {
    /// Rows every `step` [s] from `start` [s] on, as far as `duration` [s] reaches.
    ///
    /// # Errors
    /// A duration or step that is not positive and finite, or more than a hundred million rows.
    pub fn new(start: f64, duration: f64, step: f64) -> anyhow::Result<Self> {
        ensure!(
            duration.is_finite() && duration > 0.0,
            "--duration {duration}: a positive number of seconds is needed"
        );
        ensure!(
            step.is_finite() && step > 0.0,
            "--step {step}: a positive number of seconds is needed"
        );
        let steps = (duration / step + SAME_TIME).floor();
        ensure!(
            steps >= 1.0,
            "--step {step}: is longer than the run of {duration} s"
        );
        ensure!(
            steps < 1e8,
            "--step {step}: {steps} rows are more than the hundred million that can be kept"
        );
        Ok(Self {
            start,
            step,
            rows: steps as usize + 1,
        })
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn time(&self, row: usize) -> f64 {
        self.start + row as f64 * self.step
    }

    fn stop(&self) -> f64 {
        self.time(self.rows - 1)
    }
}

/// Positions of what a result has if nothing else is asked for: inputs, outputs and what sticks.
#[must_use]
pub fn usual_variables(component: &dyn Component) -> Vec<usize> {
    [Role::Input, Role::Output, Role::Local]
        .into_iter()
        .flat_map(|role| {
            let variables = component.variables().iter().enumerate();
            variables
                .filter(move |(_, variable)| variable.role == role && variable.kind != Kind::Other)
                .map(|(at, _)| at)
        })
        .collect()
}

/// Runs the component and returns inputs, outputs and what sticks, over time.
///
/// # Errors
/// As for [`simulate_variables`].
pub fn simulate(
    component: &mut dyn Component,
    drive: &Drive,
    schedule: &Schedule,
) -> anyhow::Result<Record> {
    let shown = usual_variables(component);
    simulate_variables(component, drive, schedule, &shown, &mut |_| true)
}

/// Runs the component and returns the variables at the positions `shown` over time. `go_on` hears after each row how many
/// there are; where it says no the run ends with the rows there are.
///
/// A row holds the inputs in force from its time on, so that values that follow an input at once fit it.
///
/// # Errors
/// Whatever the component refuses.
pub fn simulate_variables(
    component: &mut dyn Component,
    drive: &Drive,
    schedule: &Schedule,
    shown: &[usize],
    go_on: &mut dyn FnMut(usize) -> bool,
) -> anyhow::Result<Record> {
    let names: Vec<String> = shown
        .iter()
        .map(|&at| component.variables()[at].name.clone())
        .collect();
    let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(schedule.rows); shown.len()];
    let mut values = vec![0.0; shown.len()];
    component.set(&drive.values(0))?;
    component.initialise(schedule.start, schedule.stop())?;
    let mut time = schedule.start;
    let mut sample = 0;
    let mut rows = 0;
    for row in 0..schedule.rows {
        let target = schedule.time(row);
        while sample + 1 < drive.len() && drive.time(sample + 1) <= target + SAME_TIME {
            sample += 1;
            let change = drive.time(sample);
            if change < target - SAME_TIME {
                advance(component, &mut time, change)?;
            } else {
                advance(component, &mut time, target)?;
            }
            component.set(&drive.values(sample))?;
        }
        advance(component, &mut time, target)?;
        component.get(shown, &mut values)?;
        columns
            .iter_mut()
            .zip(&values)
            .for_each(|(column, value)| column.push(*value));
        rows += 1;
        if !go_on(rows) {
            break;
        }
    }
    let mut record = Record::new(
        component.title(),
        (0..rows).map(|row| schedule.time(row)).collect(),
    )?;
    for (name, column) in names.into_iter().zip(columns) {
        record.add_column(name, column)?;
    }
    Ok(record)
}

fn advance(component: &mut dyn Component, time: &mut f64, to: f64) -> anyhow::Result<()> {
    if to - *time > SAME_TIME {
        component.step(*time, to)?;
        *time = to;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_is_at_the_end_of_the_run() {
        let schedule = Schedule::new(0.0, 60.0, 0.01).unwrap();
        assert_eq!(schedule.rows, 6001);
        assert!((schedule.stop() - 60.0).abs() < 1e-12);
        for (duration, step) in [
            (0.0, 0.1),
            (1.0, 0.0),
            (1.0, 2.0),
            (f64::NAN, 0.1),
            (1.0, 1e-12),
        ] {
            assert!(
                Schedule::new(0.0, duration, step).is_err(),
                "{duration} {step}"
            );
        }
    }
}
