//! S3: ways between people and past them.
//!
//! The equations E1 to E26 of Ghandour, Liu, Stoll and Thurow in the reading of `spec/valley.md`.
//! People are sorted from left to right; between two neighbours, and beside the first and the last,
//! lies a *region*; a region that is wide enough is a candidate *valley*, and one is *accepted* only
//! if the straight way through it keeps clear of every tracked person and in the seen space.
//!
//! Frame: S3's. Lateral places and headings are positive to the robot's **right**, contrary to the
//! rest of the crate; [`Person::at`] and [`Valley::turn`] are the only ways in and out.
//!
//! A heading is carried as its sine, its cosine being positive: square roots take the place of
//! tangents and arc sines, and no quotient is 0/0.

use crate::gesture::PEOPLE_MAX;
use crate::math;
use crate::quantity::{Angle, OutOfRange, Speed, in_range};

/// A person: where, and how broad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    lateral: f32,
    depth: f32,
    range: f32,
    radius: f32,
}

/// The farthest that a person can be, m.
const FARTHEST: f32 = 20.0;

impl Person {
    /// A person as S3 has them: lateral place X and distance Z, with the shoulder radius r_p, all in
    /// m. The depth is (E3, E4)
    ///
    /// $$Z \cos \delta = \sqrt{Z^2 - X^2}$$
    ///
    /// # Errors
    /// [`OutOfRange`] if Z is not in 0 to 20 m, |X| greater than Z, or r_p not in 0.05 to 1 m.
    pub fn new(lateral: f32, range: f32, radius: f32) -> Result<Self, OutOfRange> {
        let range = in_range("distance of a person", range, 0.0, FARTHEST, "m")?;
        let lateral = in_range("lateral place of a person", lateral, -range, range, "m")?;
        Ok(Self {
            lateral,
            depth: math::sqrt((range - lateral) * (range + lateral)),
            range,
            radius: Self::checked_radius(radius)?,
        })
    }

    /// A person at a place of the robot's frame, m: forward at least 0, and left.
    ///
    /// # Errors
    /// [`OutOfRange`] if a coordinate is not within 10 m, somebody is behind, or r_p is not in 0.05
    /// to 1 m.
    pub fn at(forward: f32, left: f32, radius: f32) -> Result<Self, OutOfRange> {
        let depth = in_range("depth of a person", forward, 0.0, FARTHEST / 2.0, "m")?;
        let limit = FARTHEST / 2.0;
        let lateral = -in_range("lateral place of a person", left, -limit, limit, "m")?;
        Ok(Self {
            lateral,
            depth,
            range: math::sqrt(lateral * lateral + depth * depth).max(lateral.abs()),
            radius: Self::checked_radius(radius)?,
        })
    }

    fn checked_radius(radius: f32) -> Result<f32, OutOfRange> {
        in_range("shoulder radius", radius, 0.05, 1.0, "m")
    }

    /// X: lateral place, m, positive to the right.
    #[must_use]
    pub const fn lateral(&self) -> f32 {
        self.lateral
    }

    /// Z: distance, m.
    #[must_use]
    pub const fn range(&self) -> f32 {
        self.range
    }

    /// E4: depth, m.
    #[must_use]
    pub const fn depth(&self) -> f32 {
        self.depth
    }

    /// r_p: shoulder radius, m.
    #[must_use]
    pub const fn radius(&self) -> f32 {
        self.radius
    }

    /// E3: bearing in radians, in [−π/2, π/2]; 0 for somebody at the robot's place.
    ///
    /// $$\delta = \arcsin \frac{X}{Z}$$
    #[must_use]
    pub fn bearing(&self) -> f32 {
        math::atan2(self.lateral, self.depth)
    }

    /// Sines of the directions that pass this person to the left and to the right with `clearance`
    /// (m) between the person's centre and the path: sin(δ ∓ asin(c/Z)), ±1 where the direction is
    /// not ahead. None if the robot is nearer than that already.
    fn passing(&self, clearance: f32) -> Option<[f32; 2]> {
        if self.range <= clearance {
            return None;
        }
        let way = math::sqrt((self.range - clearance) * (self.range + clearance));
        let square = self.range * self.range;
        let direction = |side: f32| {
            let sine = (self.lateral * way + side * self.depth * clearance) / square;
            let ahead = self.depth * way - side * self.lateral * clearance > 0.0;
            if ahead { sine } else { 1.0_f32.copysign(sine) }
        };
        Some([direction(-1.0), direction(1.0)])
    }
}

/// Everybody who is tracked, sorted from left to right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    people: [Person; PEOPLE_MAX],
    count: usize,
}

impl Scene {
    /// Nobody.
    pub const EMPTY: Self = Self {
        people: [Person {
            lateral: 0.0,
            depth: 0.0,
            range: 0.0,
            radius: 0.0,
        }; PEOPLE_MAX],
        count: 0,
    };

    /// People in any order.
    ///
    /// # Errors
    /// [`OutOfRange`] if they are more than [`PEOPLE_MAX`].
    pub fn new(people: &[Person]) -> Result<Self, OutOfRange> {
        let mut scene = Self::EMPTY;
        if people.len() > PEOPLE_MAX {
            return Err(OutOfRange {
                field: "number of people",
                value: people.len() as f32,
                min: 0.0,
                max: PEOPLE_MAX as f32,
                unit: "people",
            });
        }
        for person in people {
            scene.insert(*person);
        }
        Ok(scene)
    }

    /// Adds a person where there is room for one.
    //= valley.INV-7
    fn insert(&mut self, person: Person) {
        let mut at = self.count.min(PEOPLE_MAX - 1);
        self.count = at + 1;
        // Equal places are told apart by everything else, so that the order given does not matter.
        while at > 0 && before(&person, &self.people[at - 1]) {
            self.people[at] = self.people[at - 1];
            at -= 1;
        }
        self.people[at] = person;
    }

    /// The people from left to right.
    #[must_use]
    pub fn people(&self) -> &[Person] {
        self.people.get(..self.count).unwrap_or(&self.people)
    }

    /// As many as the sensor can track: there may be more (ER-S3-24).
    #[must_use]
    pub const fn may_be_more(&self) -> bool {
        self.count == PEOPLE_MAX
    }
}

/// A person stands further left than another, or comes first by other numbers.
fn before(one: &Person, other: &Person) -> bool {
    let [one, other] = [one, other].map(|p| [p.lateral, p.depth, p.range, p.radius]);
    let mut i = 0;
    while i < 3 && one[i] == other[i] {
        i += 1;
    }
    one[i] < other[i]
}

/// What S3 takes as given of robot and sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    robot_radius: f32,
    safety_distance: f32,
    view_half_angle: f32,
    view_sine: f32,
    view_cosine: f32,
    view_tangent: f32,
}

/// Ways are planned by so much wider than they must be (m), so that the check does not refuse them.
const PLANNED: f32 = 5e-5;
/// Ways are checked by so much wider than they must be (m): more than floats round within 20 m.
pub const ROUNDING: f32 = 1e-5;

impl Geometry {
    /// r_r and d in m, half the sensor's angle of view in radians (35° in the paper).
    ///
    /// # Errors
    /// [`OutOfRange`] if r_r is not in 0.05 to 1 m, d not in 0 to 2 m, or the angle not in 0.1 to
    /// 1.2 rad.
    pub fn new(
        robot_radius: f32,
        safety_distance: f32,
        view_half_angle: f32,
    ) -> Result<Self, OutOfRange> {
        let view_half_angle = in_range("half angle of view", view_half_angle, 0.1, 1.2, "rad")?;
        let sine = math::sin(view_half_angle).clamp(0.09, 0.94);
        let cosine = math::cos(view_half_angle).clamp(0.35, 1.0);
        Ok(Self {
            robot_radius: in_range("robot_radius", robot_radius, 0.05, 1.0, "m")?,
            safety_distance: in_range("safety_distance", safety_distance, 0.0, 2.0, "m")?,
            view_half_angle,
            view_sine: sine,
            view_cosine: cosine,
            view_tangent: sine / cosine,
        })
    }

    /// c = r_p + r_r + d/2: how far a person's centre is to stay from the robot's way, m.
    #[must_use]
    pub fn clearance(&self, person: &Person) -> f32 {
        person.radius + self.robot_radius + self.safety_distance / 2.0
    }

    /// Distance, m, beyond which somebody straight ahead leaves a region on either side that is wide
    /// enough: E5 to E8.
    #[must_use]
    pub fn least_range(&self, radius: f32) -> f32 {
        (2.0 * self.robot_radius + radius + self.safety_distance) / self.view_tangent
    }

    /// Sine of half the angle of view.
    #[must_use]
    pub const fn view_sine(&self) -> f32 {
        self.view_sine
    }

    /// E5: the last lateral place that the sensor sees at a person's depth, m.
    #[must_use]
    pub fn edge(&self, person: &Person) -> f32 {
        person.depth * self.view_tangent
    }

    /// A place of the robot's frame (m forward, m left) is in the sensor's angle of view.
    #[must_use]
    pub fn sees(&self, forward: f32, left: f32) -> bool {
        left.abs() * self.view_cosine <= forward * self.view_sine
    }

    /// Region `index` of a scene: 0 is left of everybody, the number of people right of everybody.
    /// None if there is no such region; without people there is none at all.
    #[must_use]
    pub fn region(&self, scene: &Scene, index: usize) -> Option<Region> {
        let count = scene.count;
        if count == 0 || index > count {
            return None;
        }
        let left = index.checked_sub(1).and_then(|i| scene.people.get(i));
        let right = scene.people.get(index).filter(|_| index < count);
        match (left, right) {
            (Some(left), Some(right)) => Some(self.between(left, right)),
            (None, Some(right)) => Some(self.beside(right, -1.0)),
            (Some(left), None) => Some(self.beside(left, 1.0)),
            (None, None) => None,
        }
    }

    /// The region between two neighbours: E1, E2, E10 to E14.
    fn between(&self, left: &Person, right: &Person) -> Region {
        let farther = if left.range >= right.range {
            left
        } else {
            right
        };
        let lateral = (left.lateral + right.lateral) / 2.0;
        let range = math::sqrt(lateral * lateral + farther.depth * farther.depth);
        Region {
            left: Some(*left),
            right: Some(*right),
            available: right.lateral - left.lateral,
            least: 2.0 * self.robot_radius + left.radius + right.radius + self.safety_distance,
            lateral,
            range,
            sine: quotient(lateral, range),
            width: right.bearing() - left.bearing(),
        }
    }

    /// The region beside the last person to the right (`side` 1) or to the left (−1): E5 to E8, E17
    /// to E23.
    fn beside(&self, person: &Person, side: f32) -> Region {
        let lateral = person.lateral + side * self.clearance(person);
        // Mirrored, what is left of the first is right of the last.
        let outward = side * person.lateral;
        let neighbour = Some(*person);
        Region {
            left: if side > 0.0 { neighbour } else { None },
            right: if side > 0.0 { None } else { neighbour },
            available: (self.edge(person) - outward).max(0.0),
            least: 2.0 * self.robot_radius + person.radius + self.safety_distance,
            lateral,
            range: person.range,
            sine: quotient(lateral, person.range),
            width: self.view_half_angle - side * person.bearing(),
        }
    }

    /// The valley in region `index`, if there is an accepted one: the region is wide enough, and some
    /// direction in it, the one nearest to E14's or E19's, keeps clear of everybody and in the seen
    /// space.
    #[must_use]
    pub fn valley(&self, scene: &Scene, index: usize) -> Option<Valley> {
        let region = self.region(scene, index)?;
        if !region.is_wide_enough() {
            return None;
        }
        let sine = self.direction(scene, index, &region)?;
        let heading = Heading::new(sine);
        let length = self.length(&region, heading);
        self.admits(scene, heading, length).then_some(Valley {
            index,
            heading,
            length,
            width: region.width,
        })
    }

    /// The direction nearest to the region's own that passes everybody to the left of the region on
    /// their right, everybody to the right of it on their left, and stays in the seen space; as a
    /// sine. None if there is none.
    //= valley.INV-3
    fn direction(&self, scene: &Scene, index: usize, region: &Region) -> Option<f32> {
        let reach = self.reach(region);
        let (mut least, mut most) = (-self.view_sine, self.view_sine);
        let mut i = 0;
        while i < scene.count {
            let Some(person) = scene.people.get(i) else {
                break;
            };
            let clearance = self.clearance(person) + PLANNED;
            // Who is farther away than the way leads does not matter to it.
            if person.range - clearance < reach {
                let [left, right] = person.passing(clearance)?;
                if i < index {
                    least = least.max(right);
                } else {
                    most = most.min(left);
                }
            }
            i += 1;
        }
        // Level with the neighbour, the far side of the robot is still in the seen space.
        if let Some(left) = &region.left {
            most = most.min(self.outermost(left)?);
        }
        if let Some(right) = &region.right {
            least = least.max(-self.outermost(right)?);
        }
        (least <= most).then(|| region.sine.max(least).min(most))
    }

    /// How far the way through a region leads at most, m, whatever its direction.
    fn reach(&self, region: &Region) -> f32 {
        let reach = |person: Option<Person>| {
            person.map_or(0.0, |person| {
                person.range + person.radius + self.robot_radius + self.safety_distance
            })
        };
        reach(region.left).max(reach(region.right)) + PLANNED
    }

    /// The sine of the farthest direction to the side in which the robot, as far away as this person,
    /// is wholly in the angle of view. None if it is nowhere.
    fn outermost(&self, person: &Person) -> Option<f32> {
        let (range, radius) = (person.range, self.robot_radius);
        if range <= radius {
            return None;
        }
        let way = math::sqrt((range - radius) * (range + radius));
        Some((self.view_sine * way - self.view_cosine * radius) / range)
    }

    /// d_ca: how far it is to be driven in a direction until both neighbours are passed, m:
    /// Z cos(θ − δ) + r_p + r_r + d, the farther of the two (E16, E20, E24).
    #[must_use]
    pub fn length(&self, region: &Region, heading: Heading) -> f32 {
        let past = |person: Option<Person>| {
            person.map_or(0.0, |person| {
                let level = person.lateral * heading.sine + person.depth * heading.cosine;
                level + person.radius + self.robot_radius + self.safety_distance
            })
        };
        past(region.left).max(past(region.right))
    }

    /// Whether a straight way may be taken: in the angle of view, and clear of every person. Asked
    /// last, so that what is accepted does not rest on how it was found.
    //= valley.INV-1
    //= valley.INV-6
    #[must_use]
    pub fn admits(&self, scene: &Scene, heading: Heading, length: f32) -> bool {
        if !(heading.sine.abs() <= self.view_sine && length > 0.0 && length <= 2.0 * FARTHEST) {
            return false;
        }
        let mut i = 0;
        while i < scene.count {
            let Some(person) = scene.people.get(i) else {
                break;
            };
            let clearance = self.clearance(person) + ROUNDING;
            if !keeps_clear([person.lateral, person.depth], clearance, heading, length) {
                return false;
            }
            i += 1;
        }
        true
    }

    /// The accepted valleys of a scene, each at its region's number.
    #[must_use]
    pub fn valleys(&self, scene: &Scene) -> Valleys {
        let mut valleys = Valleys([None; REGIONS]);
        let mut index = 0;
        while index <= scene.count && index < REGIONS {
            valleys.0[index] = self.valley(scene, index);
            index += 1;
        }
        valleys
    }

    /// E25, E26: the share of the greatest speed for a valley `width` radians wide, 0 up to one degree
    /// and for what is no number, 1 from the whole angle of view on. Both angles are in degrees.
    ///
    /// $$\frac{\log \theta_r}{\log \theta_{max}}$$
    //= valley.INV-4
    //= valley.INV-5
    #[must_use]
    pub fn share(&self, width: f32) -> f32 {
        let (width, whole) = (width.to_degrees(), 2.0 * self.view_half_angle.to_degrees());
        if width >= whole {
            1.0
        } else if width > 1.0 {
            // The angle of view is at least 11°: nothing is divided by a small number.
            (math::ln(width) / math::ln(whole).max(1.0)).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// dividend/divisor for a divisor of at least 0; 0/0 is 0.
fn quotient(dividend: f32, divisor: f32) -> f32 {
    if divisor > 0.0 {
        (dividend / divisor).clamp(-1.0, 1.0)
    } else {
        0.0
    }
}

/// A straight way of `length` (m) keeps `clearance` (m) between its centre line and a person's centre
/// at (lateral, depth), ends included.
#[must_use]
pub fn keeps_clear(
    [lateral, depth]: [f32; 2],
    clearance: f32,
    heading: Heading,
    length: f32,
) -> bool {
    let along = lateral * heading.sine + depth * heading.cosine;
    if along > 0.0 && along < length {
        // Between the ends the distance is that from the line.
        let aside = lateral * heading.cosine - depth * heading.sine;
        return aside.abs() >= clearance;
    }
    let end = if along <= 0.0 { 0.0 } else { length };
    let across = lateral - heading.sine * end;
    let ahead = depth - heading.cosine * end;
    across * across + ahead * ahead >= clearance * clearance
}

/// A region between two neighbours, or beside the first or last of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    left: Option<Person>,
    right: Option<Person>,
    /// E1, E6: R_av, m.
    pub available: f32,
    /// E2, E7, E8: R_min, m.
    pub least: f32,
    /// E10, E17, E21: x_ca, m.
    pub lateral: f32,
    /// E15, E18, E22: Z_ca, m.
    pub range: f32,
    /// E14, E19, E23: sine of θ_ca.
    pub sine: f32,
    /// θ_r, radians.
    pub width: f32,
}

impl Region {
    /// E9: it belongs to the set V.
    //= valley.INV-2
    #[must_use]
    pub fn is_wide_enough(&self) -> bool {
        self.available > self.least
    }
}

/// A direction ahead, positive to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    sine: f32,
    cosine: f32,
}

impl Heading {
    /// The direction with this sine; beyond ±1, or no number, it is straight ahead.
    #[must_use]
    pub fn new(sine: f32) -> Self {
        let sine = if sine.abs() <= 1.0 { sine } else { 0.0 };
        Self {
            sine,
            cosine: math::sqrt((1.0 - sine) * (1.0 + sine)),
        }
    }

    /// Its sine, positive to the right.
    #[must_use]
    pub const fn sine(self) -> f32 {
        self.sine
    }

    /// Its cosine, at least 0.
    #[must_use]
    pub const fn cosine(self) -> f32 {
        self.cosine
    }

    /// The angle in radians, positive to the right.
    #[must_use]
    pub fn angle(self) -> f32 {
        math::atan2(self.sine, self.cosine)
    }
}

/// A way that was accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valley {
    /// The number of its region.
    pub index: usize,
    /// θ_ca.
    pub heading: Heading,
    /// d_ca, m.
    pub length: f32,
    /// θ_r, radians.
    pub width: f32,
}

impl Valley {
    /// The turn that leads into it, counter-clockwise positive as everywhere else.
    #[must_use]
    pub fn turn(&self) -> Angle {
        Angle::radians(-self.heading.angle()).unwrap_or(Angle::ZERO)
    }

    /// E25: speed through it.
    #[must_use]
    pub fn speed(&self, geometry: &Geometry, speed_max: Speed) -> Speed {
        speed_max.scaled(geometry.share(self.width))
    }

    /// E26: rate of the turn into it, rad/s, at most `turn_rate_max` (at least 0); counter-clockwise
    /// positive.
    #[must_use]
    pub fn turn_rate(&self, geometry: &Geometry, turn_rate_max: f32) -> f32 {
        let rate = turn_rate_max * geometry.share(self.width);
        if self.heading.sine > 0.0 { -rate } else { rate }
    }
}

/// As many regions as there can be.
const REGIONS: usize = PEOPLE_MAX + 1;

/// A side, seen by the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// To the robot's left.
    Left,
    /// To the robot's right.
    Right,
}

/// The accepted valleys of a scene, each at its region's number: the set V of E9.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valleys([Option<Valley>; REGIONS]);

impl Valleys {
    /// The valley in a region.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<&Valley> {
        self.0.get(index).and_then(Option::as_ref)
    }

    /// All of them, from left to right.
    pub fn iter(&self) -> impl Iterator<Item = &Valley> {
        self.0.iter().filter_map(Option::as_ref)
    }

    /// V = ∅.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// The valley nearest to the waypoint, whose direction is in radians, positive to the right.
    #[must_use]
    pub fn by_waypoint(&self, waypoint: f32) -> Option<Valley> {
        self.nearest(waypoint, 0, REGIONS)
    }

    /// The valley nearest to straight ahead, on this side of the person number `master` (from left
    /// to right, from 0).
    #[must_use]
    pub fn by_side(&self, side: Side, master: usize) -> Option<Valley> {
        match side {
            Side::Left => self.nearest(0.0, 0, master.saturating_add(1)),
            Side::Right => self.nearest(0.0, master.saturating_add(1), REGIONS),
        }
    }

    /// Of the valleys in regions `from..to` the one nearest to a direction, the first of two.
    //= valley.INV-8
    fn nearest(&self, aim: f32, from: usize, to: usize) -> Option<Valley> {
        let mut best: Option<(f32, Valley)> = None;
        let mut i = from;
        while i < to && i < REGIONS {
            if let Some(valley) = self.0[i] {
                let off = (valley.heading.angle() - aim).abs();
                if best.is_none_or(|(least, _)| off < least) {
                    best = Some((off, valley));
                }
            }
            i += 1;
        }
        best.map(|(_, valley)| valley)
    }
}
