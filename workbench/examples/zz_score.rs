#![allow(missing_docs)]
use std::path::Path;
use std::time::Instant;
use stickslip::plant::ModelFile;
use workbench::diagnose::{decide::*, fit::*, hypothesis::*, run::*, sensors::*, window::*};
use workbench::files::record::Record;
fn main() {
    rayon::ThreadPoolBuilder::new()
        .stack_size(64 << 20)
        .num_threads(2)
        .build_global()
        .unwrap();
    let root = std::env::args().nth(1).unwrap();
    let filter: Vec<String> = std::env::args()
        .skip(2)
        .filter(|a| !a.starts_with("--"))
        .collect();
    let leave = std::env::args().any(|a| a == "--leave");
    let answers: serde_json::Value = serde_json::from_str(
        &std::fs::read_to_string(Path::new(&root).join("ANSWERS.json")).unwrap(),
    )
    .unwrap();
    for (case, answer) in answers.as_object().unwrap() {
        if !filter.is_empty() && !filter.iter().any(|f| case.contains(f.as_str())) {
            continue;
        }
        let dir = Path::new(&root).join(case);
        let model = ModelFile::parse(
            &std::fs::read_to_string(dir.join("model.toml")).unwrap(),
            "model.toml",
        )
        .unwrap();
        let sensors = Sensors::default();
        let mut runs = vec![];
        for n in ["run-0.csv", "run-a.csv", "run-b.csv"] {
            let Ok(r) = Record::read(&dir.join(n)) else {
                continue;
            };
            let c = |n: &str| r.column(n).unwrap();
            runs.push(Run::new(
                n.into(),
                r.time().to_vec(),
                c("u").to_vec(),
                c("N2"),
                [c("theta"), c("theta_dot"), c("theta3"), c("theta3_dot")],
                &sensors,
            ));
        }
        let mut ws = vec![];
        for (i, r) in runs.iter().enumerate() {
            ws.extend(windows(i, r, 8.0 * 0.0602, 0.33));
        }
        let data = Data {
            runs: std::sync::Arc::new(runs),
            windows: ws,
            deviations: sensors.deviations(),
        };
        let kind = answer["kind"].as_str().unwrap().to_string();
        let truth: Vec<String> = kind
            .replace("_no_brake", "")
            .replace("_braked", "")
            .replace("_gauss", "")
            .replace("hysteresis_c", "hysteresis")
            .split("_and_")
            .map(|s| match s {
                "wobble" => "normal_force_wobble".to_string(),
                "bearing" => "bearing_friction".into(),
                s => s.to_string(),
            })
            .collect();
        let without: Vec<String> = if leave { truth.clone() } else { vec![] };
        let t = Instant::now();
        let d = diagnose(&data, Hypothesis::base(&model), &without, &mut |_| {});
        let names: Vec<&str> = d.effects.iter().map(|e| e.name).collect();
        println!(
            "{case:30} {kind:28} -> {:?} {names:?} alt {:?} misfit {:.3}->{:.3} q {}->{} left {} {:.1?}",
            d.verdict,
            d.alternatives,
            d.base.misfit(&data),
            d.amended.misfit(&data),
            d.base.disturbance.relative,
            d.amended.disturbance.relative,
            d.structure_left
                .iter()
                .take(2)
                .map(|s| format!("{:?} {:.0}[{:.0}]", s.coordinate, s.gain, s.interval95[0]))
                .collect::<Vec<_>>()
                .join("; "),
            t.elapsed()
        );
        println!(
            "      {}",
            d.ranking
                .iter()
                .take(5)
                .map(|r| format!(
                    "{} {:.0} [{:.0},{:.0}]",
                    r.name, r.gain, r.interval95[0], r.interval95[1]
                ))
                .collect::<Vec<_>>()
                .join("; ")
        );
        for e in &d.effects {
            println!(
                "      {} {}  truth {}",
                e.name,
                e.estimates
                    .iter()
                    .map(|e| format!(
                        "{}={:.5}±{:.5}",
                        e.name.split('.').nth(1).unwrap(),
                        e.value,
                        e.deviation
                    ))
                    .collect::<Vec<_>>()
                    .join(" "),
                answer["effects"]
            );
        }
    }
}
