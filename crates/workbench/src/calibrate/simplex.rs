//! Local search by the simplex method (Nelder and Mead 1965) within the unit cube.

/// Improves `start` with at most `evaluations` of `cost`; returns the best place and its cost.
pub fn improve(
    start: &[f64],
    size: f64,
    evaluations: usize,
    cost: impl Fn(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let confined =
        |place: Vec<f64>| -> Vec<f64> { place.into_iter().map(|x| x.clamp(0.0, 1.0)).collect() };
    let dimension = start.len();
    let mut corners: Vec<(Vec<f64>, f64)> = (0..=dimension)
        .map(|corner| {
            let mut place = start.to_vec();
            if corner > 0 {
                let x = &mut place[corner - 1];
                *x += if *x + size <= 1.0 { size } else { -size };
            }
            let place = confined(place);
            let value = cost(&place);
            (place, value)
        })
        .collect();
    let mut spent = dimension + 1;
    while spent < evaluations {
        corners.sort_by(|left, right| left.1.total_cmp(&right.1));
        let (least, worst) = (corners[0].1, corners[dimension].1);
        if worst - least <= 1e-10 * (1e-10 + least.abs()) {
            break;
        }
        let centre: Vec<f64> = (0..dimension)
            .map(|k| {
                corners[..dimension]
                    .iter()
                    .map(|corner| corner.0[k])
                    .sum::<f64>()
                    / dimension as f64
            })
            .collect();
        let beyond = |factor: f64| -> (Vec<f64>, f64) {
            let far = &corners[dimension].0;
            let place = confined(
                (0..dimension)
                    .map(|k| centre[k] + factor * (centre[k] - far[k]))
                    .collect(),
            );
            let value = cost(&place);
            (place, value)
        };
        let reflected = beyond(1.0);
        spent += 1;
        let next = if reflected.1 < least {
            let expanded = beyond(2.0);
            spent += 1;
            if expanded.1 < reflected.1 {
                expanded
            } else {
                reflected
            }
        } else if reflected.1 < corners[dimension - 1].1 {
            reflected
        } else {
            let contracted = beyond(if reflected.1 < worst { 0.5 } else { -0.5 });
            spent += 1;
            contracted
        };
        if next.1 < worst {
            corners[dimension] = next;
        } else {
            let lead = corners[0].0.clone();
            for corner in &mut corners[1..] {
                for (x, towards) in corner.0.iter_mut().zip(&lead) {
                    *x = 0.5 * (*x + towards);
                }
                corner.1 = cost(&corner.0);
            }
            spent += dimension;
        }
    }
    corners.sort_by(|left, right| left.1.total_cmp(&right.1));
    corners.swap_remove(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bottom_of_a_bent_valley_is_found() {
        // Rosenbrock's function.
        let cost = |place: &[f64]| {
            let (x, y) = (4.0 * place[0] - 2.0, 4.0 * place[1] - 2.0);
            (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2)
        };
        let (place, value) = improve(&[0.2, 0.6], 0.05, 2000, cost);
        assert!(value < 1e-8, "{place:?} {value}");
    }
}
