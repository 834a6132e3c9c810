//! The bars' table and the confusion matrix.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use serde::Serialize;

use super::answer::{EQUIVALENT, Group, NEARLY_PARAMETERS};
use super::judge::Judgement;
use super::reliability::{bins, calibration_error};
use super::wilson::Share;
use crate::analysis::quantile::quantile;

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// What is measured.
    pub what: String,
    /// The figure; absent where no case says anything.
    pub value: Option<f64>,
    /// Wilson's interval, for shares.
    pub interval95: Option<[f64; 2]>,
    /// Number of cases or numbers behind it.
    pub cases: usize,
    /// What is asked for.
    pub bar: String,
    /// Whether it is reached; absent without a figure.
    pub reached: Option<bool>,
}

/// The table of all figures.
#[must_use]
pub fn lines(judged: &[Judgement], without: &[Judgement]) -> Vec<Line> {
    let group = |group: Group| judged.iter().filter(move |j| j.group == group);
    let single = |j: &&Judgement| {
        matches!(
            j.group,
            Group::Full | Group::Rough | Group::Small | Group::OtherSize
        )
    };
    let at_least = |what: &str, share: Share, bar: f64| line(what, share, bar, false);
    let at_most = |what: &str, share: Share, bar: f64| line(what, share, bar, true);
    let apart = || {
        without
            .iter()
            .filter(|j| !NEARLY_PARAMETERS.contains(&j.kind.as_str()))
            .filter(|j| !EQUIVALENT.contains(&(j.kind.as_str(), j.said.as_str())))
    };
    let errors: Vec<f64> = group(Group::Full)
        .filter(|j| j.top_1)
        .flat_map(|j| j.size_errors.iter().copied())
        .collect();
    let covered: Vec<bool> = judged
        .iter()
        .filter(single)
        .filter(|j| j.top_1)
        .flat_map(|j| j.covered.iter().copied())
        .collect();
    let closed: Vec<f64> = group(Group::Full).filter_map(|j| j.closed).collect();
    let seconds: Vec<f64> = judged.iter().map(|j| j.seconds).collect();
    let bins = bins(judged);
    let coverage = Share::of(covered.iter(), |c| **c);
    let mut coverage_line = at_least("95 % intervals that cover", coverage, 0.90);
    coverage_line.bar = "90–98 %".to_owned();
    coverage_line.reached = (coverage.cases > 0).then(|| (0.90..=0.98).contains(&coverage.value()));
    vec![
        at_least(
            "top-1 right, full size",
            Share::of(group(Group::Full), |j| j.top_1),
            0.98,
        ),
        at_least(
            "top-1 right, rough",
            Share::of(group(Group::Rough), |j| j.top_1),
            0.95,
        ),
        at_least(
            "exactly the right set, full size",
            Share::of(group(Group::Full), |j| j.exact),
            0.95,
        ),
        at_least(
            "top-1 right, small",
            Share::of(group(Group::Small), |j| j.top_1),
            0.85,
        ),
        at_most(
            "wrong names, small",
            Share::of(group(Group::Small), |j| j.false_name),
            0.03,
        ),
        at_least(
            "precision of `named`",
            Share::of(judged.iter().filter(|j| j.named), |j| !j.false_name),
            0.98,
        ),
        at_least(
            "clean cases left in peace",
            Share::of(group(Group::Clean), |j| j.quiet),
            0.98,
        ),
        at_most(
            "right effect taken out: false name",
            Share::of(apart(), |j| j.named),
            0.03,
        ),
        at_least(
            "right effect taken out: flagged",
            Share::of(apart(), |j| j.flagged),
            0.90,
        ),
        at_most(
            "unknown effects: false name",
            Share::of(group(Group::Outside), |j| j.named),
            0.03,
        ),
        at_least(
            "unknown effects: flagged",
            Share::of(group(Group::Outside), |j| j.flagged),
            0.90,
        ),
        at_least(
            "effect of a file that is the hidden one: named",
            Share::of(group(Group::Supposed), |j| j.exact),
            0.95,
        ),
        at_least(
            "two effects: both, nothing else",
            Share::of(group(Group::Pair), |j| j.exact),
            0.80,
        ),
        figure(
            "size error, median",
            quantile(&errors, 0.5),
            errors.len(),
            "≤ 0.05",
            |v| v <= 0.05,
        ),
        coverage_line,
        figure(
            "expected calibration error of the probabilities",
            calibration_error(&bins),
            bins.iter().map(|bin| bin.cases).sum(),
            "≤ 0.03",
            |v| v <= 0.03,
        ),
        figure(
            "held-out gap closed, median",
            quantile(&closed, 0.5),
            closed.len(),
            "≥ 0.98",
            |v| v >= 0.98,
        ),
        figure(
            "held-out gap closed, worst tenth",
            quantile(&closed, 0.1),
            closed.len(),
            "≥ 0.90",
            |v| v >= 0.90,
        ),
        figure(
            "time per case, median [s]",
            quantile(&seconds, 0.5),
            seconds.len(),
            "≤ 5",
            |v| v <= 5.0,
        ),
        figure(
            "time per case, longest [s]",
            quantile(&seconds, 1.0),
            seconds.len(),
            "≤ 60",
            |v| v <= 60.0,
        ),
    ]
}

fn line(what: &str, share: Share, bar: f64, is_limit: bool) -> Line {
    let known = share.cases > 0;
    let sign = if is_limit { "≤" } else { "≥" };
    Line {
        what: what.to_owned(),
        value: known.then(|| share.value()),
        interval95: known.then(|| share.interval95()),
        cases: share.cases,
        bar: format!("{sign} {:.0} %", 100.0 * bar),
        reached: known.then(|| {
            if is_limit {
                share.value() <= bar
            } else {
                share.value() >= bar
            }
        }),
    }
}

fn figure(
    what: &str,
    value: Option<f64>,
    cases: usize,
    bar: &str,
    reached: impl Fn(f64) -> bool,
) -> Line {
    Line {
        what: what.to_owned(),
        value,
        interval95: None,
        cases,
        bar: bar.to_owned(),
        reached: value.map(reached),
    }
}

/// The table as Markdown.
#[must_use]
pub fn to_markdown(lines: &[Line]) -> String {
    let mut text =
        String::from("| | measured | 95 % interval | cases | bar | |\n|---|---|---|---|---|---|\n");
    for line in lines {
        let is_share = line.interval95.is_some();
        let value = match line.value {
            Some(value) if is_share => format!("{:.1} %", 100.0 * value),
            Some(value) => format!("{value:.3}"),
            None => "–".to_owned(),
        };
        let interval = line.interval95.map_or(String::new(), |[low, high]| {
            format!("{:.1}–{:.1} %", 100.0 * low, 100.0 * high)
        });
        let mark = match line.reached {
            Some(true) => "reached",
            Some(false) => "**missed**",
            None => "no case",
        };
        let _ = writeln!(
            text,
            "| {} | {value} | {interval} | {} | {} | {mark} |",
            line.what, line.cases, line.bar
        );
    }
    text
}

/// What was said for each kind, as Markdown.
#[must_use]
pub fn confusion(judged: &[Judgement]) -> String {
    let mut counts: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for j in judged {
        *counts
            .entry(&j.kind)
            .or_default()
            .entry(&j.said)
            .or_default() += 1;
    }
    let columns: BTreeSet<&str> = judged.iter().map(|j| j.said.as_str()).collect();
    let mut text = String::from("| hidden \\ said |");
    for column in &columns {
        let _ = write!(text, " {column} |");
    }
    text.push_str("\n|---|");
    text.push_str(&"---|".repeat(columns.len()));
    text.push('\n');
    for (kind, row) in counts {
        let _ = write!(text, "| {kind} |");
        for column in &columns {
            let _ = write!(
                text,
                " {} |",
                row.get(column).map_or(String::new(), ToString::to_string)
            );
        }
        text.push('\n');
    }
    text
}
