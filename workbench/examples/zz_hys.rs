#![allow(missing_docs)]
use std::path::Path;
use stickslip::plant::ModelFile;
use workbench::diagnose::{catalogue::*, fit::*, hypothesis::*, run::*, sensors::*, window::*};
use workbench::files::record::Record;
fn main() {
    rayon::ThreadPoolBuilder::new()
        .stack_size(64 << 20)
        .num_threads(2)
        .build_global()
        .unwrap();
    let case = std::env::args().nth(1).unwrap();
    let eff = std::env::args().nth(2).unwrap();
    let dir = Path::new(&case);
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
    let h = Hypothesis::base(&model);
    let mut ws = vec![];
    for (i, r) in runs.iter().enumerate() {
        ws.extend(windows(i, r, 8.0 * 0.0602, 0.33));
    }
    let data = Data {
        runs: std::sync::Arc::new(runs),
        windows: ws,
        deviations: sensors.deviations(),
    };
    let starts: Vec<_> = data.windows.iter().map(|w| w.anchor).collect();
    let base = fit(&data, h, starts, 15);
    println!("base {:.0} misfit {:.3}", base.loss, base.misfit(&data));
    for start in entry(&eff).unwrap().starts(&base.hypothesis, true) {
        let mut f = fit(
            &data,
            start,
            entry(&eff).unwrap().window_starts(&data, &base, true),
            0,
        );
        for k in 0..std::env::args().nth(3).map_or(12, |s| s.parse().unwrap()) {
            let fails = f.grams.iter().filter(|g| g.is_none()).count();
            println!(
                "{k}: loss {:.0} promised {:.0} misfit {:.3} fails {fails} q {} its {} x {:?}",
                f.loss,
                f.promised_loss(&data),
                f.misfit(&data),
                f.disturbance.relative,
                f.iterations,
                f.hypothesis
                    .x
                    .iter()
                    .map(|x| (x * 1e4).round() / 1e4)
                    .collect::<Vec<_>>()
            );
            if k == 0 {
                let red = f.reduced(&data);
                let mut v: Vec<(f64, usize)> = red
                    .iter()
                    .enumerate()
                    .map(|(i, r)| {
                        (
                            r.as_ref().map_or(-1.0, |r| r.square / r.residuals as f64),
                            i,
                        )
                    })
                    .collect();
                v.sort_by(|a, b| b.0.total_cmp(&a.0));
                for (s, i) in v.iter().take(25) {
                    let w = &data.windows[*i];
                    println!(
                        "   {:.1} {} t {:.2}-{:.2} omega {:.2} acc {:.1} N {:.1} minw {:.2}",
                        s,
                        data.runs[w.run].name,
                        data.runs[w.run].time[w.first],
                        data.runs[w.run].time[w.last],
                        w.anchor[1],
                        w.acceleration,
                        data.runs[w.run].normal_force[w.first],
                        data.runs[w.run].readings[1][w.first..=w.last]
                            .iter()
                            .fold(9e9f64, |a, b| a.min(*b))
                    );
                }
                println!(
                    "  median {:.2} p75 {:.2}",
                    v[v.len() / 2].0,
                    v[v.len() / 4].0
                );
            }
            f = fit(&data, f.hypothesis, f.starts, if k == 0 { 12 } else { 2 });
        }
    }
}
