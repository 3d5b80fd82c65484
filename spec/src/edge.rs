//! Chapter `edge`: S4's equations, the wall theorems and the invariants. See `spec/edge.md`.
//! Millimetres and degrees, as printed; the predicates take the crate's metres.

// ---------------------------------------------------------------- equations

/// S4.E1 as printed: NI = −(10/R)·(r − R) for r ≤ R, else 0. A negative range gives more than 10.
#[must_use]
pub fn e1_printed(range: f64, range_max: f64) -> f64 {
    if range <= range_max {
        -(10.0 / range_max) * (range - range_max)
    } else {
        0.0
    }
}

/// S4.E1 as read: N1 = 10·(R − r)/R for 0 ≤ r ≤ R, 0 beyond; none for what is no range.
#[must_use]
pub fn e1(range: f64, range_max: f64) -> Option<f64> {
    (range >= 0.0).then(|| 10.0 * (range_max - range).max(0.0) / range_max)
}

/// S4.E2 as printed: N2 = 0.4 − (0.6/D)·(d − D) for d ≤ D, else 0: off the edge all detection is
/// switched off, and a signed d gives more than 1.
#[must_use]
pub fn e2_printed(distance: f64, distance_max: f64) -> f64 {
    if distance <= distance_max {
        0.4 - (0.6 / distance_max) * (distance - distance_max)
    } else {
        0.0
    }
}

/// S4.E2 as read: N2 = 1 − 0.6·|d|/D for |d| ≤ D; beyond, none: the detector is blind.
#[must_use]
pub fn e2(distance: f64, distance_max: f64) -> Option<f64> {
    (distance.abs() <= distance_max).then(|| 1.0 - 0.6 * distance.abs() / distance_max)
}

/// S4.E3 as printed, with r_i read as the distance in mm: up to 1500, and zero at contact.
#[must_use]
pub fn e3_printed(n1: f64, n2: f64, range: f64) -> f64 {
    n1 * n2 * range
}

/// S4.E4 as printed: P = |Nf|·cos α, with the sign of the cosine.
#[must_use]
pub fn e4_printed(nf: f64, alpha_deg: f64) -> f64 {
    nf.abs() * alpha_deg.to_radians().cos()
}

/// S4.E3 and E4 as read, r_i a unit vector: P = N1·N2·max(0, cos α).
#[must_use]
pub fn e4(n1: f64, n2: f64, alpha_deg: f64) -> f64 {
    n1 * n2 * alpha_deg.to_radians().cos().max(0.0)
}

/// α: the angle between a sonar's axis and the actual edge, degrees.
#[must_use]
pub fn alpha(heading_deg: f64, actual_edge_deg: f64, axis_deg: f64) -> f64 {
    heading_deg + axis_deg - actual_edge_deg
}

/// The actual edge: |d| in mm and its direction in degrees.
#[must_use]
pub fn actual_edge(robot: [f64; 2], start: [f64; 2], end: [f64; 2]) -> (f64, f64) {
    let (dx, dy) = (end[0] - start[0], end[1] - start[1]);
    let cross = dx * (robot[1] - start[1]) - dy * (robot[0] - start[0]);
    let direction = (end[1] - robot[1]).atan2(end[0] - robot[0]).to_degrees();
    (cross.abs() / dx.hypot(dy), direction)
}

/// The range up to which an echo at angle α is detected, mm; none if it never is.
#[must_use]
pub fn detection_range(
    distance: f64,
    alpha_deg: f64,
    threshold: f64,
    range_max: f64,
    distance_max: f64,
) -> Option<f64> {
    let gain = e2(distance, distance_max)? * alpha_deg.to_radians().cos();
    let range = range_max * (1.0 - threshold / (10.0 * gain));
    (gain > 0.0 && range > 0.0).then_some(range)
}

/// The greatest P of a single ray on a wall parallel to the actual edge, over all headings:
/// 10·N2·(1 − κ^⅔)^1.5 with κ = (W/2 − d − ρ)/R.
#[must_use]
pub fn ray_wall_bound(width: f64, distance: f64, rho: f64, range_max: f64, n2: f64) -> f64 {
    let kappa = (width / 2.0 - distance - rho) / range_max;
    if kappa >= 1.0 {
        0.0
    } else {
        10.0 * n2 * (1.0 - kappa.max(0.0).powf(2.0 / 3.0)).powf(1.5)
    }
}

/// What is bounded in W1: a robot whose sonar faces lie within ρ of its centre, in a corridor.
#[derive(Clone, Copy, Debug)]
pub struct Corridor {
    /// Distance of either wall from the planned edge at least, W/2, mm.
    pub half_width: f64,
    /// ρ, mm.
    pub rho: f64,
    /// Half the opening angle of the cones, radians.
    pub half_angle: f64,
    /// R, mm.
    pub range_max: f64,
    /// D, mm.
    pub distance_max: f64,
}

/// The paper's corridor with the P3-DX's front ring and a cone of 30° either way.
pub const PAPER_CORRIDOR: Corridor = Corridor {
    half_width: 600.0,
    rho: 168.2,
    half_angle: core::f64::consts::FRAC_PI_6,
    range_max: 600.0,
    distance_max: 300.0,
};

/// Interval of numbers, its ends rounded outwards by whoever computes with it.
pub type Interval = [f64; 2];

/// Relative error that covers a handful of roundings and a library sine.
const SLACK: f64 = 1e-12;

impl Corridor {
    /// W1, near wall: an upper bound of P for all robots at a distance from the edge in `distance`
    /// (mm), whatever sonar and heading, whose sonar axis makes with the wall an angle in `axis`
    /// (radians, 0 to π/2).
    ///
    /// The wall is at least W/2 − d − ρ from the face. A ray in the cone strikes it at an angle of
    /// at most θ + h, so the range is at least that distance over sin(min(θ + h, π/2)). The actual
    /// edge turns away from the near wall, so α ≥ θ. Each factor is monotone, so its value at one
    /// end of the interval bounds it.
    #[must_use]
    pub fn near_wall(&self, distance: Interval, axis: Interval) -> f64 {
        let gap = self.half_width - distance[1] - self.rho;
        let steepest = (axis[1] + self.half_angle).min(core::f64::consts::FRAC_PI_2);
        let range = gap / (steepest.sin() * (1.0 + SLACK)) * (1.0 - SLACK);
        let n1 = 10.0 * (1.0 - range / self.range_max).clamp(0.0, 1.0);
        let n2 = 1.0 - 0.6 * distance[0] / self.distance_max;
        n1 * n2 * axis[0].cos() * (1.0 + 4.0 * SLACK)
    }

    /// W1, far wall: the actual edge may point at it, but it is never nearer to the centre than W/2.
    #[must_use]
    pub fn far_wall(&self) -> f64 {
        let range = self.half_width - self.rho;
        10.0 * (1.0 - range / self.range_max).clamp(0.0, 1.0) * (1.0 + 4.0 * SLACK)
    }

    /// W1: the greatest upper bound over `cells` by `cells` boxes that cover every distance up to D
    /// and every axis, and over the far wall. It is a bound on P, not an estimate.
    #[must_use]
    pub fn wall_bound(&self, cells: u32) -> f64 {
        let cut = |k: u32, end: f64| {
            let part = |k: u32| end * f64::from(k) / f64::from(cells);
            [part(k) * (1.0 - SLACK), part(k + 1) * (1.0 + SLACK)]
        };
        let mut bound = self.far_wall();
        for i in 0..cells {
            for j in 0..cells {
                let distance = cut(i, self.distance_max);
                let axis = cut(j, core::f64::consts::FRAC_PI_2);
                bound = bound.max(self.near_wall(distance, axis));
            }
        }
        bound
    }
}

/// W2: nothing farther than this from the robot's centre gives more than the threshold, mm:
/// R·(1 − t/10) + ρ.
#[must_use]
pub fn harmless_distance(range_max: f64, threshold: f64, rho: f64) -> f64 {
    range_max * (1.0 - threshold / 10.0) + rho
}

/// Free stretches: width, middle and whether a safe path fits, mm.
#[must_use]
pub fn free_gap(right: f64, left: f64, safe_path_width: f64) -> (f64, f64, bool) {
    let width = left - right;
    (width, (left + right) / 2.0, width >= safe_path_width)
}

// --------------------------------------------------------------- invariants

/// edge.INV-1: N1 is in [0, 10], and 0 from R on.
#[must_use]
pub fn nearness_in_range(nearness: f32, range: f32, range_max: f32) -> bool {
    (0.0..=10.0).contains(&nearness) && (range < range_max || nearness == 0.0)
}

/// edge.INV-2: N2 is in [0.4, 1] within D, and there is none beyond. The constants are the paper's,
/// and so is what `f32` makes of them.
#[must_use]
pub fn closeness_in_range(closeness: Option<f32>, distance: f32, distance_max: f32) -> bool {
    match closeness {
        Some(n2) => (0.399_999..=1.0).contains(&n2) && distance.abs() <= distance_max,
        // The quotient of two floats may round past 1 at the last bit below D only.
        None => distance.is_nan() || distance.abs() >= 0.999_999 * distance_max,
    }
}

/// edge.INV-3: 0 ≤ P ≤ 10·N2 ≤ 10.
#[must_use]
pub fn projection_in_range(projection: f32, closeness: f32) -> bool {
    (0.0..=10.0 * closeness).contains(&projection) && projection <= 10.0
}

/// edge.INV-4, W2: an echo from R·(1 − t/10) on, and a hundred-thousandth more for what floats round,
/// gives no more than the threshold t.
#[must_use]
pub fn far_is_harmless(projection: f32, range: f32, range_max: f32, threshold: f32) -> bool {
    let harmless = range_max * (1.0 - threshold / 10.0);
    range < harmless * 1.00001 || projection <= threshold
}

/// edge.INV-5, W1: no side wall gives more than 2.9.
#[must_use]
pub fn wall_is_harmless(projection: f64) -> bool {
    projection <= 2.9
}

/// edge.INV-6: whoever is off the edge, or does not hear a sonar, does not say "clear".
#[must_use]
pub fn blind_is_not_clear(
    clear: bool,
    distance: f32,
    distance_max: f32,
    every_sonar_heard: bool,
) -> bool {
    !clear || (distance.abs() <= distance_max && every_sonar_heard)
}

/// edge.INV-7: an obstacle is reported exactly where a projection exceeds the threshold, and it is
/// the greatest that is reported.
#[must_use]
pub fn obstacle_is_greatest(reported: Option<f32>, projections: &[f32], threshold: f32) -> bool {
    match reported {
        Some(greatest) => {
            greatest > threshold
                && projections.contains(&greatest)
                && projections.iter().all(|p| *p <= greatest)
        }
        None => projections.iter().all(|p| *p <= threshold),
    }
}

/// edge.INV-14: where what no side wall can give exceeds the threshold as it would on the edge, an
/// obstacle is reported.
#[must_use]
pub fn inside_counts_in_full(obstacle: bool, on_the_edge: &[f32], threshold: f32) -> bool {
    obstacle || on_the_edge.iter().all(|p| *p <= threshold)
}

/// edge.INV-15: an echo that is left as one that no side can give comes from between the sides, for
/// every ray of its cone; `places` across the edge.
#[must_use]
pub fn left_is_inside(is_left: bool, places: &[f64], right: f64, left: f64) -> bool {
    !is_left || places.iter().all(|y| (right..=left).contains(y))
}

/// edge.INV-8: advice is finite, its speed in [0, v_max] and its turn rate in [−ω_max, ω_max].
#[must_use]
pub fn advice_in_range(speed: f32, turn_rate: f32, speed_max: f32, turn_rate_max: f32) -> bool {
    (0.0..=speed_max).contains(&speed) && (-turn_rate_max..=turn_rate_max).contains(&turn_rate)
}

/// edge.INV-9: a state at rest advises no motion at all.
#[must_use]
pub fn rests(at_rest: bool, speed: f32, turn_rate: f32) -> bool {
    !at_rest || (speed == 0.0 && turn_rate == 0.0)
}

/// edge.INV-10: what is on the way stops whoever moves.
#[must_use]
pub fn obstacle_stops(was_moving: bool, obstacle: bool, now_stopped: bool) -> bool {
    !(was_moving && obstacle) || now_stopped
}

/// edge.INV-11: nobody drives on past what stopped them without a look at the free way.
#[must_use]
pub fn looks_before_going(stopped_or_measuring: bool, now_at_rest: bool) -> bool {
    !stopped_or_measuring || now_at_rest
}

/// edge.INV-12: a sub-route is taken only where there is room for a safe path, an edge is reported
/// blocked only where there is none, or it was tried too often.
#[must_use]
pub fn finding_decides(passable: bool, now_sub_route: bool) -> bool {
    passable == now_sub_route
}

/// edge.INV-13: what is called passable is as wide as a safe path, and no hit of the scan lies inside
/// it (metres across the edge), to a tenth of a millimetre, which is what floats round over a scan.
#[must_use]
pub fn gap_is_free(right: f32, left: f32, passable: bool, width: f32, hits: &[f32]) -> bool {
    (!passable || left - right >= width - 1.01e-4)
        && hits.iter().all(|y| *y <= right + 1e-4 || *y >= left - 1e-4)
}
