//! A body on one coordinate by tiny steps of Runge and Kutta, written without the library: events by bisection of a step.

/// A run whose acceleration is a function of time, position, velocity and direction of motion.
pub struct Reference<F> {
    time: f64,
    pub x: f64,
    pub v: f64,
    /// How often it has come to rest.
    pub turns: u32,
    step: f64,
    acceleration: F,
}

impl<F: Fn(f64, f64, f64, f64) -> f64> Reference<F> {
    pub fn new(x: f64, v: f64, step: f64, acceleration: F) -> Self {
        Self {
            time: 0.0,
            x,
            v,
            turns: 0,
            step,
            acceleration,
        }
    }

    fn after(&self, h: f64, direction: f64) -> [f64; 2] {
        let a = |t: f64, x: f64, v: f64| (self.acceleration)(t, x, v, direction);
        let (t, x, v) = (self.time, self.x, self.v);
        let k1 = a(t, x, v);
        let k2 = a(t + 0.5 * h, x + 0.5 * h * v, v + 0.5 * h * k1);
        let k3 = a(
            t + 0.5 * h,
            x + 0.5 * h * v + 0.25 * h * h * k1,
            v + 0.5 * h * k2,
        );
        let k4 = a(t + h, x + h * v + 0.5 * h * h * k2, v + h * k3);
        [
            x + h * v + h * h / 6.0 * (k1 + k2 + k3),
            v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4),
        ]
    }

    fn go(&mut self, h: f64, direction: f64) {
        [self.x, self.v] = self.after(h, direction);
        self.time += h;
    }

    /// The direction in which it moves; `None` where it is held.
    fn direction(&self) -> Option<f64> {
        if self.v != 0.0 {
            return Some(self.v.signum());
        }
        [1.0, -1.0]
            .into_iter()
            .find(|way| way * (self.acceleration)(self.time, self.x, 0.0, *way) > 0.0)
    }

    /// Stays where it is over a step, or until it breaks away on the way.
    fn wait(&mut self, h: f64) {
        let begin = self.time;
        let (mut low, mut high) = (0.0, h);
        for _ in 0..60 {
            self.time = begin + high;
            if self.direction().is_none() {
                return;
            }
            let middle = 0.5 * (low + high);
            self.time = begin + middle;
            if self.direction().is_none() {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.time = begin + high;
    }

    /// Goes on until `until`, at which its forces may jump.
    pub fn advance(&mut self, until: f64) {
        while until - self.time > 1e-13 {
            let h = self.step.min(until - self.time);
            let Some(direction) = self.direction() else {
                self.wait(h);
                continue;
            };
            if self.after(h, direction)[1] * direction >= 0.0 {
                self.go(h, direction);
                continue;
            }
            let (mut low, mut high) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.after(middle, direction)[1] * direction >= 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            self.go(high, direction);
            self.v = 0.0;
            self.turns += 1;
        }
    }
}
