//! Defects of what a solver from outside needs, for [`mutations`](crate::mutations).

use build_fmu::lint::Rule;

use crate::spoiled::Defect::{self, Replace};

/// In an FMI 2 FMU of the reduced rig.
pub const EXCHANGE_FMI2: &[(&str, Rule, Defect)] = &[
    (
        "derivative of nothing",
        Rule::ModelExchange,
        Replace(" derivative=\"4\"", " derivative=\"400\""),
    ),
    (
        "derivative without state",
        Rule::ModelExchange,
        Replace(" derivative=\"4\"", ""),
    ),
    (
        "two derivatives of a state",
        Rule::ModelExchange,
        Replace(" derivative=\"5\"", " derivative=\"4\""),
    ),
    (
        "derivative not listed",
        Rule::ModelExchange,
        Replace("<Unknown index=\"30\" dependencies=\"5\"/>", ""),
    ),
    (
        "missing InitialUnknown",
        Rule::ModelExchange,
        Replace(
            "<Unknown index=\"30\" dependencies=\"2 ",
            "<Unknown index=\"31\" dependencies=\"2 ",
        ),
    ),
    (
        "dependency of no kind",
        Rule::ModelExchange,
        Replace(
            "<Unknown index=\"30\" dependencies=\"5\"/>",
            "<Unknown index=\"30\" dependencies=\"5\" dependenciesKind=\"linear\"/>",
        ),
    ),
    (
        "indicators without number",
        Rule::ModelExchange,
        Replace(
            "numberOfEventIndicators=\"5\"",
            "numberOfEventIndicators=\"five\"",
        ),
    ),
    (
        "reinit of no state",
        Rule::ModelExchange,
        Replace(
            "<Real declaredType=\"Torque\" unit=\"N.m\"/>",
            "<Real declaredType=\"Torque\" unit=\"N.m\" reinit=\"true\"/>",
        ),
    ),
    (
        "discrete state",
        Rule::ModelExchange,
        Replace(
            "description=\"Angle of disc D2\" causality=\"output\" variability=\"continuous\"",
            "description=\"Angle of disc D2\" causality=\"output\" variability=\"discrete\"",
        ),
    ),
    (
        "derivative from outside",
        Rule::ModelExchange,
        Replace(
            "description=\"Time derivative of i\" causality=\"local\"",
            "description=\"Time derivative of i\" causality=\"input\"",
        ),
    ),
];

/// In an FMI 3 FMU of the reduced rig.
pub const EXCHANGE_FMI3: &[(&str, Rule, Defect)] = &[
    (
        "derivative of nothing",
        Rule::ModelExchange,
        Replace(" derivative=\"3\"", " derivative=\"300\""),
    ),
    (
        "derivative without state",
        Rule::ModelExchange,
        Replace(" derivative=\"3\"", ""),
    ),
    (
        "derivative of a Boolean",
        Rule::ModelExchange,
        Replace(" derivative=\"3\"", " derivative=\"9\""),
    ),
    (
        "two derivatives of a state",
        Rule::ModelExchange,
        Replace(" derivative=\"4\"", " derivative=\"3\""),
    ),
    (
        "derivative not listed",
        Rule::ModelExchange,
        Replace(
            "<ContinuousStateDerivative valueReference=\"29\" dependencies=\"4\"/>",
            "",
        ),
    ),
    (
        "missing InitialUnknown",
        Rule::ModelExchange,
        Replace(
            "<InitialUnknown valueReference=\"29\"",
            "<InitialUnknown valueReference=\"30\"",
        ),
    ),
    (
        "InitialUnknown that is known",
        Rule::ModelExchange,
        Replace(
            "<InitialUnknown valueReference=\"29\"",
            "<InitialUnknown valueReference=\"3\"",
        ),
    ),
    (
        "dependency of no kind",
        Rule::ModelExchange,
        Replace(
            "<ContinuousStateDerivative valueReference=\"29\" dependencies=\"4\"/>",
            "<ContinuousStateDerivative valueReference=\"29\" dependencies=\"4\" dependenciesKind=\"linear\"/>",
        ),
    ),
    (
        "indicator of nothing",
        Rule::ModelExchange,
        Replace(
            "<EventIndicator valueReference=\"34\"/>",
            "<EventIndicator valueReference=\"340\"/>",
        ),
    ),
    (
        "indicator twice",
        Rule::ModelExchange,
        Replace(
            "<EventIndicator valueReference=\"34\"/>",
            "<EventIndicator valueReference=\"35\"/>",
        ),
    ),
    (
        "indicator that is a Boolean",
        Rule::ModelExchange,
        Replace(
            "<EventIndicator valueReference=\"34\"/>",
            "<EventIndicator valueReference=\"9\"/>",
        ),
    ),
    (
        "discrete state",
        Rule::ModelExchange,
        Replace(
            "description=\"Angle of disc D2\" causality=\"output\" variability=\"continuous\"",
            "description=\"Angle of disc D2\" causality=\"output\" variability=\"discrete\"",
        ),
    ),
];
