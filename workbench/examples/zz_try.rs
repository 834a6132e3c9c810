#![allow(missing_docs)]
use std::path::Path;
use std::time::Instant;
use stickslip::plant::ModelFile;
use workbench::diagnose::{
    fit::*, hypothesis::*, run::*, search::*, sensors::*, structure::*, window::*,
};
use workbench::files::record::Record;
fn main() {
    rayon::ThreadPoolBuilder::new()
        .stack_size(64 << 20)
        .num_threads(2)
        .build_global()
        .unwrap();
    for case in std::env::args().skip(1) {
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
        let mut windows_ = vec![];
        for (i, r) in runs.iter().enumerate() {
            windows_.extend(windows(i, r, 8.0 * 0.0602, 0.33));
        }
        let data = Data {
            runs: std::sync::Arc::new(runs),
            windows: windows_,
            deviations: sensors.deviations(),
        };
        let starts: Vec<_> = data.windows.iter().map(|w| w.anchor).collect();
        let t = Instant::now();
        let g = grams(&data, &h, &starts);
        let el = t.elapsed();
        let fails = g.iter().filter(|g| g.is_none()).count();
        let t = Instant::now();
        let f = fit(&data, h, starts, 15);
        let red = f.reduced(&data);
        let m: usize = red.iter().flatten().map(|r| r.residuals).sum();
        let sq: f64 = red.iter().flatten().map(|r| r.square).sum();
        let mut per: Vec<f64> = red
            .iter()
            .flatten()
            .map(|r| r.square / r.residuals as f64)
            .collect();
        per.sort_by(|a, b| a.total_cmp(b));
        println!(
            "{}: windows {} fails {} pass {:?}; fit {:?} its {} loss {:.1} chi2/m {:.4} median {:.3} p95 {:.2} max {:.1} q {}",
            dir.file_name().unwrap().to_str().unwrap(),
            data.windows.len(),
            fails,
            el,
            t.elapsed(),
            f.iterations,
            f.loss,
            sq / m as f64,
            per[per.len() / 2],
            per[per.len() * 95 / 100],
            per[per.len() - 1],
            f.disturbance.relative
        );
        let t = Instant::now();
        let tried = try_all(&data, &f, &[], &mut |_| {});
        println!("   all candidates {:?}", t.elapsed());
        let t = Instant::now();
        let show = |f: &Fit, n: &str| {
            let st = structures(&data, f);
            print!(
                "   structure after {n}: misfit {:.3} q {} ",
                f.misfit(&data),
                f.disturbance.relative
            );
            for s in st.iter().take(4) {
                print!(
                    "{:?} {:.1} [{:.0},{:.0}]; ",
                    s.coordinate, s.gain, s.interval95[0], s.interval95[1]
                );
            }
            println!();
        };
        show(&f, "base");
        for c in tried.iter().take(2) {
            show(&c.fit, c.name);
        }
        println!("   structures {:?}", t.elapsed());
        for c in tried.iter().take(4) {
            let cov = c.fit.covariance(&data);
            let est: Vec<String> = c
                .fit
                .hypothesis
                .estimates(|i, j| cov.as_ref().map_or(0.0, |c| c[(i, j)]))
                .iter()
                .filter(|e| !e.is_nominal)
                .map(|e| format!("{} {:.5}±{:.5}", e.name, e.value, e.deviation))
                .collect();
            println!(
                "   {:24} gain {:10.1} [{:.1}, {:.1}] loss gain {:.1} q {} its {} {:?}",
                c.name,
                c.gain,
                c.interval95[0],
                c.interval95[1],
                (f.loss - c.fit.loss) / 2.0,
                c.fit.disturbance.relative,
                c.fit.iterations,
                est
            );
        }
    }
}
