//! Chapter `valley`: S3's equations and invariants. See `spec/valley.md`.
//!
//! Lengths in m, angles in degrees where S3 gives degrees. X is lateral, positive to S3's right; Z
//! is the radial distance.

// ---------------------------------------------------------------- equations

/// A person: lateral place X, distance Z and shoulder radius r_p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    /// X, m.
    pub lateral: f64,
    /// Z, m.
    pub range: f64,
    /// r_p, m.
    pub radius: f64,
}

/// What S3 takes as given: r_r, d (m) and half the sensor's angle of view (degrees).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// r_r, m.
    pub robot_radius: f64,
    /// d, m.
    pub safety_distance: f64,
    /// 35 in the paper.
    pub view_half_angle_deg: f64,
}

/// S3.E1: width of the region between two neighbours.
#[must_use]
pub fn e1(left: f64, right: f64) -> f64 {
    right - left
}

/// S3.E2: least width between two people.
#[must_use]
pub fn e2(geometry: &Geometry, left: f64, right: f64) -> f64 {
    2.0 * geometry.robot_radius + right + left + geometry.safety_distance
}

/// S3.E3: bearing δ of a person in degrees; NaN where |X| > Z.
#[must_use]
pub fn e3(lateral: f64, range: f64) -> f64 {
    (lateral / range).asin().to_degrees()
}

/// S3.E4: depth Z cos δ.
#[must_use]
pub fn e4(lateral: f64, range: f64) -> f64 {
    range * e3(lateral, range).to_radians().cos()
}

/// S3.E5: the last that the sensor sees at a person's depth.
#[must_use]
pub fn e5(lateral: f64, range: f64, view_half_angle_deg: f64) -> f64 {
    e4(lateral, range) * view_half_angle_deg.to_radians().tan()
}

/// S3.E6 as printed: width of the region to the right of a person at `lateral`; for the left one,
/// mirrored.
#[must_use]
pub fn e6_printed(edge: f64, lateral: f64) -> f64 {
    (edge - lateral).abs()
}

/// S3.E6 as read: a person outside the view leaves no region.
#[must_use]
pub fn e6(edge: f64, lateral: f64) -> f64 {
    (edge - lateral).max(0.0)
}

/// S3.E7 and E8 as printed: least width of a terminal region.
#[must_use]
pub fn e7_printed(geometry: &Geometry, radius: f64) -> f64 {
    geometry.robot_radius + radius + geometry.safety_distance / 2.0
}

/// S3.E7 and E8 as read: the whole robot and its margin lie in the seen space.
#[must_use]
pub fn e7(geometry: &Geometry, radius: f64) -> f64 {
    2.0 * geometry.robot_radius + radius + geometry.safety_distance
}

/// S3.E10 as printed: half the width.
#[must_use]
pub fn e10_printed(left: f64, right: f64) -> f64 {
    (right - left) / 2.0
}

/// S3.E10 as read: the middle.
#[must_use]
pub fn e10(left: f64, right: f64) -> f64 {
    f64::midpoint(left, right)
}

/// S3.E14: heading to the middle of an intermediate valley, degrees.
#[must_use]
pub fn e14(lateral: f64, depth: f64) -> f64 {
    lateral.atan2(depth).to_degrees()
}

/// S3.E15 as read: distance of the middle, without 0/0.
#[must_use]
pub fn e15(lateral: f64, depth: f64) -> f64 {
    lateral.hypot(depth)
}

/// S3.E16 as printed.
#[must_use]
pub fn e16_printed(geometry: &Geometry, distance: f64, radius: f64) -> f64 {
    distance + geometry.robot_radius + radius + geometry.safety_distance
}

/// S3.E17, E21: x_ca of a terminal valley; `side` is 1 to the right, −1 to the left.
#[must_use]
pub fn e17(geometry: &Geometry, person: &Person, side: f64) -> f64 {
    person.lateral + side * clearance(geometry, person)
}

/// S3.E19, E23: heading of a terminal valley in degrees; NaN where |x_ca| > Z_ca.
#[must_use]
pub fn e19(lateral: f64, range: f64) -> f64 {
    (lateral / range).asin().to_degrees()
}

/// S3.E20, and E24 with its sign corrected: x_ca/tan θ_ca + r_p + r_r; NaN where |x_ca| > Z_ca.
#[must_use]
pub fn e20_printed(geometry: &Geometry, lateral: f64, range: f64, radius: f64) -> f64 {
    (range * range - lateral * lateral).sqrt() + radius + geometry.robot_radius
}

/// S3.E24 as printed, the sign included.
#[must_use]
pub fn e24_printed(geometry: &Geometry, lateral: f64, range: f64, radius: f64) -> f64 {
    (range * range - lateral * lateral).sqrt() - radius - geometry.robot_radius
}

/// S3.E25 and E26 as printed: the share of the greatest speed for a width of θ_r degrees.
#[must_use]
pub fn e25_printed(width_deg: f64, view_angle_deg: f64) -> f64 {
    width_deg.log10() / view_angle_deg.log10()
}

/// S3.E25 and E26 as read: in [0, 1], 0 up to a degree and for what is no number.
#[must_use]
pub fn e25(width_deg: f64, view_angle_deg: f64) -> f64 {
    if width_deg > 1.0 {
        e25_printed(width_deg, view_angle_deg).min(1.0)
    } else {
        0.0
    }
}

/// The Time column of Tables IV and V: turn on the spot, then drive.
#[must_use]
pub fn time(distance: f64, heading_deg: f64, speed: f64, turn_rate: f64) -> f64 {
    distance / speed + heading_deg.to_radians().abs() / turn_rate
}

/// How the tables choose: the candidate heading nearest to `aim` (degrees), the first of two.
#[must_use]
pub fn nearest(candidates: &[f64], aim: f64) -> Option<f64> {
    let off = |heading: &f64| (heading - aim).abs();
    candidates
        .iter()
        .copied()
        .min_by(|one, other| off(one).total_cmp(&off(other)))
}

/// c = r_p + r_r + d/2: how far a person's centre is to stay from the robot's path.
#[must_use]
pub fn clearance(geometry: &Geometry, person: &Person) -> f64 {
    person.radius + geometry.robot_radius + geometry.safety_distance / 2.0
}

/// Distance (m) of a person's centre from the straight path of `length` m in direction `heading_deg`.
#[must_use]
pub fn distance_from_path(person: &Person, heading_deg: f64, length: f64) -> f64 {
    let depth = (person.range * person.range - person.lateral * person.lateral)
        .max(0.0)
        .sqrt();
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    let along = (person.lateral * sin + depth * cos).clamp(0.0, length);
    (person.lateral - along * sin).hypot(depth - along * cos)
}

/// One region with everything that S3 computes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Number of the region: 0 is left of everybody.
    pub index: usize,
    /// R_av, m.
    pub available: f64,
    /// R_min, m.
    pub least: f64,
    /// x_ca, m.
    pub lateral: f64,
    /// Z_ca, m.
    pub range: f64,
    /// θ_ca, degrees; NaN where undefined.
    pub heading_deg: f64,
    /// d_ca, m.
    pub length: f64,
    /// θ_r, degrees.
    pub width_deg: f64,
}

impl Region {
    /// R_av > R_min: in the set V of S3.E9.
    #[must_use]
    pub fn wide_enough(&self) -> bool {
        self.available > self.least
    }

    /// Least distance from anybody's body (centre less r_p) to the straight path, m.
    #[must_use]
    pub fn gap(&self, people: &[Person]) -> f64 {
        people
            .iter()
            .map(|person| distance_from_path(person, self.heading_deg, self.length) - person.radius)
            .fold(f64::INFINITY, f64::min)
    }
}

/// People sorted by X, S3's order.
#[must_use]
pub fn sorted(people: &[Person]) -> Vec<Person> {
    let mut sorted = people.to_vec();
    sorted.sort_by(|one, other| one.lateral.total_cmp(&other.lateral));
    sorted
}

/// The regions between and beside people, left to right. `printed` is with E6 to E8, E19 and E20
/// as printed (indices, midpoint and sign of E24 corrected); otherwise as read. No regions without
/// people.
#[must_use]
pub fn regions(people: &[Person], geometry: &Geometry, printed: bool) -> Vec<Region> {
    let people = sorted(people);
    let count = people.len();
    let half = geometry.view_half_angle_deg;
    if count == 0 {
        return Vec::new();
    }
    // How far it is to be driven until a person is passed, as read.
    let passed = |person: &Person, heading: f64| {
        let off = (heading - e3(person.lateral, person.range)).to_radians();
        person.range * off.cos() + person.radius + geometry.robot_radius + geometry.safety_distance
    };
    let terminal = |person: &Person, side: f64, index: usize| {
        // Mirrored, a left region is a right one.
        let edge = e5(person.lateral, person.range, half);
        let outward = side * person.lateral;
        let lateral = e17(geometry, person, side);
        let bearing = e3(person.lateral, person.range);
        let heading = e19(lateral, person.range);
        let tangent = bearing
            + side
                * (clearance(geometry, person) / person.range)
                    .asin()
                    .to_degrees();
        let (available, least, heading, length) = if printed {
            let length = e20_printed(geometry, lateral, person.range, person.radius);
            (
                e6_printed(edge, outward),
                e7_printed(geometry, person.radius),
                heading,
                length,
            )
        } else {
            let outer = side * (side * heading).max(side * tangent);
            (
                e6(edge, outward),
                e7(geometry, person.radius),
                outer,
                passed(person, outer),
            )
        };
        Region {
            index,
            available,
            least,
            lateral,
            range: person.range,
            heading_deg: heading,
            length,
            width_deg: half - side * bearing,
        }
    };
    let mut regions = vec![terminal(&people[0], -1.0, 0)];
    for i in 1..count {
        let (left, right) = (&people[i - 1], &people[i]);
        let farther = if left.range >= right.range {
            left
        } else {
            right
        };
        let depth = e4(farther.lateral, farther.range);
        let lateral = e10(left.lateral, right.lateral);
        let range = e15(lateral, depth);
        let heading = e14(lateral, depth);
        regions.push(Region {
            index: i,
            available: e1(left.lateral, right.lateral),
            least: e2(geometry, left.radius, right.radius),
            lateral,
            range,
            heading_deg: heading,
            length: if printed {
                e16_printed(geometry, range, farther.radius)
            } else {
                passed(left, heading).max(passed(right, heading))
            },
            width_deg: e3(right.lateral, right.range) - e3(left.lateral, left.range),
        });
    }
    regions.push(terminal(&people[count - 1], 1.0, count));
    regions
}

// --------------------------------------------------------------- invariants

/// valley.INV-1: a way was accepted only if the straight path of `length` in the direction with this
/// sine and cosine keeps at least `clearance` from a person's centre at (lateral, depth), ends
/// included. In `f32`, as decided; the same from outside is [`path_is_clear`].
#[must_use]
pub fn keeps_clear(
    [lateral, depth]: [f32; 2],
    clearance: f32,
    [sin, cos]: [f32; 2],
    length: f32,
) -> bool {
    let along = lateral * sin + depth * cos;
    let nearest = if along <= 0.0 {
        [0.0, 0.0]
    } else if along >= length {
        [sin * length, cos * length]
    } else {
        // Between the ends the distance is that from the line.
        return (lateral * cos - depth * sin).abs() >= clearance;
    };
    let [across, ahead] = [lateral - nearest[0], depth - nearest[1]];
    across * across + ahead * ahead >= clearance * clearance
}

/// valley.INV-1, from outside: exact geometry, no rounding of the law's.
#[must_use]
pub fn path_is_clear(person: &Person, geometry: &Geometry, heading_deg: f64, length: f64) -> bool {
    distance_from_path(person, heading_deg, length) >= clearance(geometry, person)
}

/// valley.INV-2: the width decides before the clearance is looked at: strictly more than needed, and
/// nothing else.
#[must_use]
pub fn decided_by_width(wide_enough: bool, available: f32, least: f32) -> bool {
    wide_enough == (available > least)
}

/// valley.INV-3: shrinking a person, the robot or the margin takes no valley away.
#[must_use]
pub fn none_taken_away(before: &[bool], after: &[bool]) -> bool {
    before.len() == after.len() && before.iter().zip(after).all(|(was, is)| !was || *is)
}

/// valley.INV-4: the share of the greatest speed lies in [0, 1].
#[must_use]
pub fn is_share(share: f32) -> bool {
    (0.0..=1.0).contains(&share)
}

/// valley.INV-5: a wider valley is driven no slower.
#[must_use]
pub fn no_slower(narrow: f32, wide: f32) -> bool {
    narrow <= wide
}

/// valley.INV-6: the direction of an accepted valley is defined and within the angle of view, and
/// its length is a length.
#[must_use]
pub fn is_defined(sine: f32, view_sine: f32, length: f32) -> bool {
    sine.abs() <= view_sine && view_sine < 1.0 && length > 0.0 && length.is_finite()
}

/// valley.INV-7: the order in which people are given makes no difference.
#[must_use]
pub fn same_for_any_order<T: PartialEq>(one: &T, other: &T) -> bool {
    one == other
}

/// valley.INV-8: what is chosen was a candidate, on the ordered side, and no other candidate there
/// is nearer to the aim.
#[must_use]
pub fn is_nearest(chosen: f32, aim: f32, candidates: &[f32]) -> bool {
    candidates.contains(&chosen)
        && candidates
            .iter()
            .all(|other| (chosen - aim).abs() <= (other - aim).abs())
}
