//! An independent simulator in the simplest form: Runge–Kutta steps of a fixed length on the equations of
//! motion, bisection where the gap closes, the impact law. It shares no code with the simulator under test,
//! has no stick episodes and misses contacts between two steps.

/// The kind of absorber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Absorber {
    /// A free mass.
    Mass,
    /// A pendulum.
    Pendulum {
        /// L, from the pivot to the centre of mass.
        length: f64,
        /// L, the distance from the pivot to the centre of mass.
        contact: f64,
        /// b, the distance from the pivot to the point of contact.
        inertia: f64,
        /// r = ωp/ωn.
        frequency_ratio: f64,
        /// True for the exact equations with sinθ and cosθ, false for small angles.
        large_angles: bool,
    },
}

/// A harmonic excitation amplitude · cos(frequency t + phase), f/M on the primary or acceleration of the
/// base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Amplitude of f/M or a_g.
    pub amplitude: f64,
    /// Angular frequency Ω in ωn.
    pub frequency: f64,
    /// Phase at time zero.
    pub phase: f64,
    /// True if it moves the base.
    pub base: bool,
}

/// A scene in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Mass ratio μ.
    pub mass_ratio: f64,
    /// Restitution e.
    pub restitution: f64,
    /// One-sided clearance d.
    pub clearance: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// The absorber.
    pub absorber: Absorber,
    /// The excitation; `None` for free decay.
    pub drive: Option<Drive>,
    /// x, ẋ, y, w at time zero.
    pub start: [f64; 4],
    /// Length of the run, in 1/ωn.
    pub duration: f64,
}

/// x and ẋ, and x₁ and ẋ₁ of a free mass or θ and θ̇ of a pendulum.
type State = [f64; 4];

/// An impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Instant, in 1/ωn.
    pub time: f64,
    /// Wall, ±1.
    pub wall: f64,
    /// Primary velocity just before and after, gap velocity just before and after.
    pub velocities: [f64; 4],
}

/// A run up to its end, or to where this method is no longer reliable.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its impacts.
    pub impacts: Vec<Impact>,
    /// Instant at which it ended, in 1/ωn.
    pub end: f64,
    /// x, ẋ, y, w at that instant.
    pub last: [f64; 4],
}

impl Scene {
    fn begin(&self) -> State {
        let [x, v, y, w] = self.start;
        match self.absorber {
            Absorber::Mass => [x, v, x + y, v + w],
            Absorber::Pendulum { contact, large_angles: true, .. } => {
                let angle = (y / contact).asin();
                [x, v, angle, w / (contact * angle.cos())]
            }
            Absorber::Pendulum { contact, .. } => [x, v, y / contact, w / contact],
        }
    }

    /// y and w.
    fn gap(&self, [x, v, p, q]: State) -> [f64; 2] {
        match self.absorber {
            Absorber::Mass => [p - x, q - v],
            Absorber::Pendulum { contact, large_angles: true, .. } => {
                [contact * p.sin(), contact * p.cos() * q]
            }
            Absorber::Pendulum { contact, .. } => [contact * p, contact * q],
        }
    }

    fn slope(&self, time: f64, [x, v, p, q]: State) -> State {
        let (mut push, mut base) = (0.0, 0.0);
        if let Some(drive) = self.drive {
            let value = drive.amplitude * (drive.frequency * time + drive.phase).cos();
            *(if drive.base { &mut base } else { &mut push }) = value;
        }
        let mu = self.mass_ratio;
        let bare = push - x - 2.0 * self.damping_ratio * v;
        match self.absorber {
            Absorber::Mass => [v, bare - base, q, -base],
            Absorber::Pendulum { length, inertia, frequency_ratio, large_angles, .. } => {
                let gravity = inertia * length * frequency_ratio * frequency_ratio;
                let (s, c, whirl) =
                    if large_angles { (p.sin(), p.cos(), length * q * q) } else { (p, 1.0, 0.0) };
                // (1+μ)(ẍ + a_g) + μL(θ̈ c − θ̇² s) = bare,  κLθ̈ = −(ẍ + a_g) c − g s
                let absolute = (bare + mu * s * whirl + mu / inertia * c * gravity * s)
                    / (1.0 + mu - mu / inertia * c * c);
                let swing = -(absolute * c + gravity * s) / (inertia * length);
                [v, absolute - base, q, swing]
            }
        }
    }

    fn step(&self, time: f64, state: State, h: f64) -> State {
        let along = |k: State, h: f64| std::array::from_fn(|i| state[i] + h * k[i]);
        let a = self.slope(time, state);
        let b = self.slope(time + h / 2.0, along(a, h / 2.0));
        let c = self.slope(time + h / 2.0, along(b, h / 2.0));
        let d = self.slope(time + h, along(c, h));
        std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    }

    fn struck(&self, [x, v, p, q]: State) -> State {
        let (mu, e) = (self.mass_ratio, self.restitution);
        match self.absorber {
            Absorber::Mass => {
                // textbook: common velocity ± restitution
                let common = (v + mu * q) / (1.0 + mu);
                let w = -e * (q - v);
                [x, common - mu / (1.0 + mu) * w, p, common + w / (1.0 + mu)]
            }
            Absorber::Pendulum { length, large_angles, .. } => {
                let c = if large_angles { p.cos() } else { 1.0 };
                [x, v + mu * (1.0 + e) / (1.0 + mu) * length * c * q, p, -e * q]
            }
        }
    }

    /// Runs in steps of `h`. The run ends early before an impact slower than `low`, and before an extremum of
    /// the gap displacement closer than `margin` to a wall.
    pub fn run(&self, h: f64, low: f64, margin: f64) -> Run {
        let d = self.clearance;
        let outside = |state: State| self.gap(state)[0].abs() > d;
        let (mut time, mut state) = (0.0, self.begin());
        let mut impacts = Vec::new();
        let done = |impacts, end, state| {
            let [y, w] = self.gap(state);
            Run { impacts, end, last: [state[0], state[1], y, w] }
        };
        while time < self.duration {
            let h = h.min(self.duration - time);
            let next = self.step(time, state, h);
            let ([_, before], [y, after]) = (self.gap(state), self.gap(next));
            if !outside(next) {
                let turned = before * y > 0.0 && before * after <= 0.0;
                if turned && d - y.abs() < margin {
                    return done(impacts, time, state);
                }
                (time, state) = (time + h, next);
                continue;
            }
            // bisection on the sign of d − |y|, down to neighbouring doubles; inside at `from`
            let (mut from, mut to) = (0.0, h);
            loop {
                let middle = 0.5 * (from + to);
                if middle <= from || middle >= to {
                    break;
                }
                if outside(self.step(time, state, middle)) { to = middle } else { from = middle }
            }
            let contact = self.step(time, state, from);
            let [y, approach] = self.gap(contact);
            if y * approach <= 0.0 || approach.abs() < low {
                return done(impacts, time, state);
            }
            let left = self.struck(contact);
            impacts.push(Impact {
                time: time + from,
                wall: y.signum(),
                velocities: [contact[1], left[1], approach, self.gap(left)[1]],
            });
            (time, state) = (time + from, left);
        }
        done(impacts, time, state)
    }
}
