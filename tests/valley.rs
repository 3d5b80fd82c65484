//! Chapter `valley`: S3's equations, what is accepted, and its Tables IV and V.
#![allow(clippy::approx_constant, reason = "3.14 m is a measured width")]

mod common;

use approx::assert_abs_diff_eq;
use common::{any_f32, cases};
use proptest::prelude::*;
use sidestep::gesture::PEOPLE_MAX;
use sidestep::quantity::Speed;
use sidestep::valley::{Geometry, Heading, Person, Region, Scene, Side, Valley};
use sidestep_spec::valley as law;

/// S3's sensor with a robot radius and a safety distance (m).
fn kinect(robot_radius: f32, safety_distance: f32) -> Geometry {
    Geometry::new(robot_radius, safety_distance, 35_f32.to_radians()).expect("a geometry")
}

/// Any geometry there is.
fn geometry() -> impl Strategy<Value = Geometry> {
    let angle = prop_oneof![3 => Just(35_f32.to_radians()), 1 => 0.1_f32..=1.2];
    (0.05_f32..=1.0, 0.0_f32..=2.0, angle).prop_map(|(radius, distance, angle)| {
        Geometry::new(radius, distance, angle).expect("within range")
    })
}

/// The numbers of a person: mostly one in view, and anywhere ahead.
fn numbers() -> impl Strategy<Value = [f32; 3]> {
    let bearing = prop_oneof![4 => -0.61_f32..0.61, 1 => -1.57_f32..1.57, 1 => Just(0.0)];
    let range = prop_oneof![4 => 0.8_f32..5.0, 1 => 0.0_f32..20.0];
    (bearing, range, 0.05_f32..0.4).prop_map(|(bearing, range, radius)| {
        // The sine of at most 90°: never more than the range, whatever rounds.
        let lateral = (range * bearing.sin()).clamp(-range, range);
        [lateral, range, radius]
    })
}

fn person([lateral, range, radius]: [f32; 3]) -> Person {
    Person::new(lateral, range, radius).expect("a person")
}

/// Nobody to six people.
fn people() -> impl Strategy<Value = Vec<Person>> {
    proptest::collection::vec(numbers().prop_map(person), 0..=PEOPLE_MAX)
}

fn scene(people: &[Person]) -> Scene {
    Scene::new(people).expect("at most six")
}

fn reference(person: &Person) -> law::Person {
    law::Person {
        lateral: person.lateral().into(),
        range: person.range().into(),
        radius: person.radius().into(),
    }
}

/// The clearance that a geometry asks for, in `f64`.
fn reference_geometry(robot_radius: f32, safety_distance: f32) -> law::Geometry {
    law::Geometry {
        robot_radius: robot_radius.into(),
        safety_distance: safety_distance.into(),
        view_half_angle_deg: 35.0,
    }
}

fn accepted(geometry: &Geometry, scene: &Scene) -> Vec<bool> {
    let valleys = geometry.valleys(scene);
    (0..=PEOPLE_MAX)
        .map(|index| valleys.get(index).is_some())
        .collect()
}

/// The angle of view is a cone about straight ahead, and far enough away it is as wide as a region has to
/// be.
#[test]
fn the_view_is_a_cone() {
    for half in [0.2_f32, 35_f32.to_radians(), 1.1] {
        let geometry = Geometry::new(0.3, 0.2, half).expect("a geometry");
        let wide = |forward: f32| forward * half.tan();
        for forward in [0.5_f32, 1.0, 4.0] {
            for side in [-1.0, 1.0] {
                assert!(geometry.sees(forward, side * 0.99 * wide(forward)));
                assert!(!geometry.sees(forward, side * 1.01 * wide(forward)));
            }
            assert!(!geometry.sees(-forward, 0.0));
        }
        assert_abs_diff_eq!(wide(geometry.least_range(0.25)), 1.05, epsilon = 1e-4);
    }
}

proptest! {
    #![proptest_config(cases(4_000))]

    /// Whatever was accepted keeps clear of everybody, judged in `f64` and from outside, without any
    /// tolerance; and as the core judges it.
    //= valley.INV-1
    #[test]
    fn accepted_ways_are_clear(
        people in people(), radius in 0.05_f32..=0.5, distance in 0.0_f32..=1.0,
    ) {
        let geometry = kinect(radius, distance);
        let outside = reference_geometry(radius, distance);
        for valley in geometry.valleys(&scene(&people)).iter() {
            let sine = valley.heading.sine();
            let heading = f64::from(sine).asin().to_degrees();
            for person in &people {
                prop_assert!(law::path_is_clear(
                    &reference(person), &outside, heading, valley.length.into()
                ), "{person:?} {valley:?}");
                prop_assert!(law::keeps_clear(
                    [person.lateral(), person.depth()],
                    geometry.clearance(person),
                    [sine, valley.heading.cosine()],
                    valley.length,
                ));
            }
        }
    }

    //= valley.INV-2
    #[test]
    fn width_decides_first(people in people(), geometry in geometry()) {
        let scene = scene(&people);
        for index in 0..=PEOPLE_MAX + 1 {
            match geometry.region(&scene, index) {
                Some(region) => {
                    prop_assert!(!people.is_empty() && index <= people.len());
                    prop_assert!(law::decided_by_width(
                        region.is_wide_enough(), region.available, region.least
                    ));
                    prop_assert!(region.available >= 0.0 && region.least > 0.0);
                    prop_assert!(region.is_wide_enough() || geometry.valley(&scene, index).is_none());
                }
                None => {
                    prop_assert!(people.is_empty() || index > people.len());
                    prop_assert!(geometry.valley(&scene, index).is_none());
                }
            }
        }
    }

    /// Thinner people, a thinner robot, a smaller margin: what was accepted still is.
    //= valley.INV-3
    #[test]
    fn shrinking_takes_no_valley_away(
        people in proptest::collection::vec(numbers(), 0..=PEOPLE_MAX),
        robot in 0.05_f32..=0.5, distance in 0.0_f32..=1.0,
        shrunk in proptest::collection::vec(0.0_f32..=1.0, PEOPLE_MAX + 2),
    ) {
        let before: Vec<Person> = people.iter().copied().map(person).collect();
        let after: Vec<Person> = people
            .iter()
            .zip(&shrunk)
            .map(|(&[lateral, range, radius], share)| {
                person([lateral, range, 0.05 + (radius - 0.05) * share])
            })
            .collect();
        let thinner = 0.05 + (robot - 0.05) * shrunk[PEOPLE_MAX];
        let nearer = distance * shrunk[PEOPLE_MAX + 1];
        let was = accepted(&kinect(robot, distance), &scene(&before));
        let is = accepted(&kinect(thinner, nearer), &scene(&after));
        // Equal lateral places are ordered by radius too: who is who may change.
        let mut places: Vec<f32> = before.iter().map(Person::lateral).collect();
        places.sort_by(f32::total_cmp);
        prop_assume!(places.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert!(law::none_taken_away(&was, &is), "{was:?} {is:?}");
    }

    //= valley.INV-4
    //= valley.INV-5
    #[test]
    fn share_is_a_monotone_share(one in any_f32(), other in any_f32(), geometry in geometry()) {
        let (narrow, wide) = if one <= other { (one, other) } else { (other, one) };
        let [slow, fast] = [narrow, wide].map(|width| geometry.share(width));
        prop_assert!(law::is_share(slow) && law::is_share(fast));
        if !narrow.is_nan() && !wide.is_nan() {
            prop_assert!(law::no_slower(slow, fast));
        }
    }

    /// The share is the reference's.
    #[test]
    fn share_is_the_reference(width in 0.0_f32..100.0) {
        let share = kinect(0.25, 0.3).share(width.to_radians());
        let reference = law::e25(f64::from(width.to_radians()).to_degrees(), 70.0);
        prop_assert!((f64::from(share) - reference).abs() <= 2e-6, "{share} {reference}");
    }

    //= valley.INV-6
    #[test]
    fn accepted_ways_are_defined(people in people(), geometry in geometry()) {
        for valley in geometry.valleys(&scene(&people)).iter() {
            let sine = valley.heading.sine();
            prop_assert!(law::is_defined(sine, geometry.view_sine(), valley.length));
            prop_assert!(valley.heading.cosine() > 0.0);
            prop_assert!(valley.turn().get().abs() <= 1.21);
            let speed_max = Speed::metres_per_second(0.3).expect("a speed");
            prop_assert!(valley.speed(&geometry, speed_max) <= speed_max);
            prop_assert!(valley.turn_rate(&geometry, 0.5).abs() <= 0.5);
        }
    }

    //= valley.INV-7
    #[test]
    fn order_makes_no_difference(people in people(), geometry in geometry(), seed in any::<u64>()) {
        let mut shuffled = people.clone();
        let mut state = seed;
        for i in (1..shuffled.len()).rev() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            shuffled.swap(i, (state >> 33) as usize % (i + 1));
        }
        let (one, other) = (scene(&people), scene(&shuffled));
        prop_assert!(law::same_for_any_order(&one, &other));
        prop_assert!(law::same_for_any_order(&geometry.valleys(&one), &geometry.valleys(&other)));
    }

    //= valley.INV-8
    #[test]
    fn the_nearest_is_chosen(
        people in people(), aim in -3.1_f32..=3.1, master in 0..PEOPLE_MAX,
    ) {
        let geometry = kinect(0.2, 0.2);
        let valleys = geometry.valleys(&scene(&people));
        let angles = |inside: &dyn Fn(&Valley) -> bool| -> Vec<f32> {
            valleys.iter().filter(|valley| inside(valley)).map(|v| v.heading.angle()).collect()
        };
        match valleys.by_waypoint(aim) {
            Some(chosen) => {
                let all = angles(&|_| true);
                prop_assert!(law::is_nearest(chosen.heading.angle(), aim, &all));
            }
            None => prop_assert!(valleys.is_empty()),
        }
        for side in [Side::Left, Side::Right] {
            let there = angles(&|valley| (valley.index <= master) == (side == Side::Left));
            match valleys.by_side(side, master) {
                Some(chosen) => {
                    prop_assert!(law::is_nearest(chosen.heading.angle(), 0.0, &there));
                }
                None => prop_assert!(there.is_empty()),
            }
        }
    }

    /// Mirrored people leave mirrored regions.
    #[test]
    fn left_and_right_are_alike(people in people()) {
        let mut ranges: Vec<f32> = people.iter().map(Person::range).collect();
        ranges.sort_by(f32::total_cmp);
        prop_assume!(ranges.windows(2).all(|pair| pair[0] < pair[1]));
        let geometry = kinect(0.25, 0.3);
        let mirrored: Vec<Person> = people
            .iter()
            .map(|p| person([-p.lateral(), p.range(), p.radius()]))
            .collect();
        let (one, other) = (scene(&people), scene(&mirrored));
        prop_assume!(people.iter().all(|p| people.iter().filter(|q| q.lateral() == p.lateral()).count() == 1));
        for index in 0..=people.len() {
            let here = geometry.valley(&one, index);
            let there = geometry.valley(&other, people.len() - index);
            prop_assert_eq!(here.is_some(), there.is_some());
            if let (Some(here), Some(there)) = (here, there) {
                prop_assert!((here.heading.sine() + there.heading.sine()).abs() < 1e-5);
                prop_assert!((here.length - there.length).abs() < 1e-4);
            }
        }
    }

    /// The core's equations are the reference's.
    #[test]
    fn regions_are_the_reference(
        people in proptest::collection::vec(numbers().prop_map(person), 1..=PEOPLE_MAX),
        radius in 0.05_f32..=0.5, distance in 0.0_f32..=1.0,
    ) {
        let mut places: Vec<f32> = people.iter().map(Person::lateral).collect();
        places.sort_by(f32::total_cmp);
        prop_assume!(places.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assume!(people.iter().all(|p| p.range() > 0.1));
        // Where the directions come near 90° an arc sine loses half its digits.
        prop_assume!(people.iter().all(|p| p.depth() > 0.05 * p.range()));
        let geometry = kinect(radius, distance);
        let scene = scene(&people);
        let references: Vec<law::Person> = people.iter().map(reference).collect();
        let outside = reference_geometry(radius, distance);
        for expected in law::regions(&references, &outside, false) {
            let found = geometry.region(&scene, expected.index).expect("a region");
            let Region { available, least, lateral, range, width, .. } = found;
            for (found, expected) in [
                (available, expected.available),
                (least, expected.least),
                (lateral, expected.lateral),
                (range, expected.range),
                (width, expected.width_deg.to_radians()),
            ] {
                prop_assert!((f64::from(found) - expected).abs() <= 2e-5 * expected.abs().max(1.0));
            }
        }
    }

    /// Which direction is taken, by angles in `f64`: the nearest to the region's own that passes everybody
    /// whom the way comes level with on their side, the neighbours with the whole robot in the seen space.
    /// Where there clearly is one it is taken, and where there clearly is none, none is.
    //= valley.INV-3
    #[test]
    fn the_nearest_clear_direction_is_taken(
        people in proptest::collection::vec(numbers().prop_map(person), 1..=PEOPLE_MAX),
        radius in 0.05_f32..=0.5, distance in 0.0_f32..=1.0,
    ) {
        let geometry = kinect(radius, distance);
        let scene = scene(&people);
        let people = scene.people();
        let half = 35_f64.to_radians();
        let (robot, margin) = (f64::from(radius), f64::from(distance));
        for index in 0..=people.len() {
            let region = geometry.region(&scene, index).expect("a region");
            let neighbours = [index.checked_sub(1), Some(index)].map(|i| people.get(i?));
            let reach = neighbours.iter().flatten().map(|p| {
                f64::from(p.range() + p.radius()) + robot + margin
            });
            let reach = reach.fold(0.0, f64::max);
            let (mut least, mut most) = (-half, half);
            let mut close = false;
            for (i, person) in people.iter().enumerate() {
                let [range, bearing] = [person.range(), person.bearing()].map(f64::from);
                let clearance = f64::from(person.radius()) + robot + margin / 2.0;
                // Nobody whose place decides by a hair's breadth.
                prop_assume!((range - clearance).abs() > 1e-3 && (range - clearance - reach).abs() > 1e-3);
                if range < clearance {
                    close = true;
                } else if range - clearance < reach {
                    let off = (clearance / range).asin();
                    if i < index {
                        least = least.max(bearing + off);
                    } else {
                        most = most.min(bearing - off);
                    }
                }
            }
            for (side, neighbour) in neighbours.into_iter().enumerate() {
                let Some(neighbour) = neighbour else { continue };
                let range = f64::from(neighbour.range());
                prop_assume!((range - robot).abs() > 1e-3);
                // The cosine law for the arc on which the robot is as far away as they are.
                let outermost = if range > robot { half - (robot / range).asin() } else { -9.0 };
                if side == 0 {
                    most = most.min(outermost);
                } else {
                    least = least.max(-outermost);
                }
            }
            prop_assume!((region.available - region.least).abs() > 1e-4);
            prop_assume!((most - least).abs() > 2e-3);
            let open = region.is_wide_enough() && !close && least < most;
            let valley = geometry.valley(&scene, index);
            prop_assert_eq!(valley.is_some(), open, "{} to {}, {:?}", least, most, region);
            if let Some(valley) = valley {
                let own = f64::from(region.sine).asin();
                let expected = own.max(least).min(most);
                let found = f64::from(valley.heading.angle());
                prop_assert!((found - expected).abs() < 1e-3, "{found} for {expected}");
            }
        }
    }

    /// A straight way keeps clear of a point as the distance of the two has it, in `f64`.
    //= valley.INV-1
    #[test]
    fn keeping_clear_is_a_distance(
        lateral in -3.0_f32..3.0, depth in -1.0_f32..4.0, clearance in 0.05_f32..2.0,
        sine in -0.9_f32..0.9, length in 0.1_f32..4.0,
    ) {
        let heading = Heading::new(sine);
        let [x, y, s, c] = [lateral, depth, heading.sine(), heading.cosine()].map(f64::from);
        let along = (x * s + y * c).clamp(0.0, length.into());
        let away = (x - s * along).hypot(y - c * along);
        prop_assume!((away - f64::from(clearance)).abs() > 1e-5);
        let clear = sidestep::valley::keeps_clear([lateral, depth], clearance, heading, length);
        prop_assert_eq!(clear, away > f64::from(clearance));
    }

    /// What is refused is named, and nothing that is no number is let in.
    #[test]
    fn only_people_are_people(one in any_f32(), other in any_f32(), radius in any_f32()) {
        for made in [Person::new(one, other, radius), Person::at(other, one, radius)] {
            match made {
                Ok(person) => {
                    let (lateral, depth) = (person.lateral(), person.depth());
                    prop_assert!((0.05..=1.0).contains(&person.radius()));
                    prop_assert!((0.0..=20.0).contains(&person.range()));
                    prop_assert!(lateral.abs() <= person.range() && depth >= 0.0);
                    prop_assert!(person.bearing().abs() <= 1.571);
                }
                Err(error) => prop_assert!(!(error.min..=error.max).contains(&error.value)),
            }
        }
    }

    #[test]
    fn only_geometries_are_geometries(one in any_f32(), other in any_f32(), angle in any_f32()) {
        match Geometry::new(one, other, angle) {
            Ok(geometry) => prop_assert!(geometry.view_sine() > 0.0 && geometry.view_sine() < 1.0),
            Err(error) => prop_assert!(!(error.min..=error.max).contains(&error.value)),
        }
    }

    #[test]
    fn any_sine_is_a_heading(sine in any_f32()) {
        let heading = Heading::new(sine);
        prop_assert!(heading.sine().abs() <= 1.0 && (0.0..=1.0).contains(&heading.cosine()));
        prop_assert!(heading.angle().abs() <= 1.571);
    }
}

/// The share rises with the width, over every single `f32` from 1° to 70°.
//= valley.INV-5
#[test]
fn share_rises_bit_by_bit() {
    let geometry = kinect(0.25, 0.3);
    let (from, to) = (1_f32.to_radians().to_bits(), 70_f32.to_radians().to_bits());
    let mut before = 0.0;
    for bits in from..=to {
        let share = geometry.share(f32::from_bits(bits));
        assert!(law::is_share(share) && law::no_slower(before, share));
        before = share;
    }
    assert_eq!(before, 1.0);
}

/// More than six are refused by number; six may be more.
#[test]
fn six_may_be_more() {
    let people = [person([0.0, 3.0, 0.2]); 7];
    let error = Scene::new(&people).expect_err("seven");
    assert_eq!((error.field, error.value), ("number of people", 7.0));
    for count in 0..=6 {
        let scene = scene(&people[..count]);
        assert_eq!(scene.may_be_more(), count == PEOPLE_MAX);
        assert_eq!(scene.people().len(), count);
        // Six in one place leave the same two ways as one.
        let valleys = kinect(0.25, 0.3).valleys(&scene);
        assert_eq!(valleys.iter().count(), if count == 0 { 0 } else { 2 });
    }
}

/// People are placed up to 10 m ahead and to either side; beyond it the place is named.
#[test]
fn people_are_placed_within_ten_metres() {
    for [forward, left] in [[10.0, 0.0], [0.0, 10.0], [10.0, -10.0], [0.0, 0.0]] {
        let person = Person::at(forward, left, 0.2).expect("a person");
        assert_eq!([person.depth(), person.lateral()], [forward, -left]);
    }
    let refused = |forward: f32, left: f32| {
        let error = Person::at(forward, left, 0.2).expect_err("too far away, or behind");
        (error.field, error.min, error.max)
    };
    assert_eq!(refused(10.01, 0.0), ("depth of a person", 0.0, 10.0));
    assert_eq!(refused(-0.01, 0.0), ("depth of a person", 0.0, 10.0));
    for left in [-10.01, 10.01] {
        let place = "lateral place of a person";
        assert_eq!(refused(1.0, left), (place, -10.0, 10.0));
    }
}

/// Whatever the people, a way has a length, up to twice as far as anybody can be, and is in the angle of
/// view.
#[test]
fn ways_are_ways() {
    let geometry = kinect(0.25, 0.3);
    let admits =
        |sine: f32, length: f32| geometry.admits(&Scene::EMPTY, Heading::new(sine), length);
    let edge = geometry.view_sine();
    for sine in [-edge, 0.0, edge] {
        assert!(admits(sine, 0.1) && admits(sine, 40.0));
        for length in [0.0, -1.0, 40.1, f32::NAN, f32::INFINITY] {
            assert!(!admits(sine, length), "{length} m");
        }
    }
    assert!(!admits(edge + 1e-3, 1.0) && !admits(-edge - 1e-3, 1.0));
}

/// Somebody at the robot's own place is in no direction, and the region beside them is straight ahead.
#[test]
fn at_the_robots_place_there_is_no_direction() {
    let geometry = kinect(0.25, 0.3);
    let here = scene(&[person([0.0, 0.0, 0.2])]);
    for index in [0, 1] {
        let region = geometry.region(&here, index).expect("beside them");
        assert_eq!((region.sine, region.range), (0.0, 0.0));
    }
}

/// Of two valleys as near to the aim as each other the left one is taken.
#[test]
fn of_two_alike_the_left_one() {
    let valleys = kinect(0.25, 0.3).valleys(&scene(&[person([0.0, 3.0, 0.2])]));
    let angles = [0, 1].map(|index| valleys.get(index).expect("a valley").heading.angle());
    assert_eq!(angles[0], -angles[1]);
    let chosen = valleys.by_waypoint(0.0).expect("a valley");
    assert_eq!(chosen.index, 0);
}

/// ER-S3-09: the counterexamples of straight paths that hit somebody are not accepted.
#[test]
fn known_counterexamples_are_refused() {
    let geometry = kinect(0.25, 0.3);
    // Depths as lateral and depth.
    let at = |lateral: f32, depth: f32| Person::at(depth, -lateral, 0.2).expect("a person");
    let unequal = scene(&[at(0.2, 1.5), at(1.9, 4.0)]);
    let region = geometry.region(&unequal, 1).expect("between them");
    assert!(region.is_wide_enough());
    let heading = Heading::new(region.sine);
    assert_abs_diff_eq!(heading.angle().to_degrees(), 14.71, epsilon = 0.01);
    assert!(!geometry.admits(&unequal, heading, geometry.length(&region, heading)));
    assert_eq!(geometry.valley(&unequal, 1), None);

    let behind = scene(&[at(0.9, 1.5), at(1.0, 4.0)]);
    let region = geometry.region(&behind, 2).expect("right of both");
    let heading = Heading::new(region.sine);
    assert_abs_diff_eq!(heading.angle().to_degrees(), 22.83, epsilon = 0.01);
    assert!(!geometry.admits(&behind, heading, geometry.length(&region, heading)));

    // ER-S3-06: somebody outside the view leaves no region on that side.
    let outside = scene(&[Person::new(2.2, 2.6, 0.2).expect("a person")]);
    let region = geometry.region(&outside, 1).expect("right of them");
    assert_eq!(region.available, 0.0);
    assert_eq!(geometry.valley(&outside, 1), None);
}

/// Somebody who is nearer than the clearance bars every way.
#[test]
fn nobody_is_passed_from_inside_their_clearance() {
    let geometry = kinect(0.25, 0.3);
    let near = Person::at(0.1, 0.5, 0.2).expect("a person");
    assert!(near.range() < geometry.clearance(&near));
    for far in [Person::at(3.0, -0.5, 0.2), Person::at(3.0, 0.9, 0.2)] {
        let scene = scene(&[near, far.expect("a person")]);
        assert!(geometry.valleys(&scene).is_empty());
    }
}

/// One row of Table IV or V.
struct Row {
    name: &'static str,
    function: &'static str,
    speed_max: f64,
    turn_rate_max: f64,
    candidates: &'static [f64],
    waypoint: Option<f64>,
    heading: f64,
    length: f64,
    width: f64,
    speed: f64,
    turn_rate: f64,
    time: f64,
    /// The printed turn rate follows from the printed width: readings, §7a.
    reproducible: bool,
}

macro_rules! rows {
    ($($name:literal $function:literal $v:literal $w:literal $candidates:expr, $waypoint:expr,
        $heading:literal $d:literal $width:literal $speed:literal $rate:literal $time:literal $ok:literal;)+) => {
        &[$(Row {
            name: $name, function: $function, speed_max: $v, turn_rate_max: $w,
            candidates: &$candidates, waypoint: $waypoint, heading: $heading, length: $d,
            width: $width, speed: $speed, turn_rate: $rate, time: $time, reproducible: $ok,
        }),+]
    };
}

/// S3 Tables IV and V.
#[allow(clippy::approx_constant, reason = "a distance of the paper, not π")]
const TABLES: &[Row] = rows! {
    "IV.1" "right" 0.2 0.4 [25.4, -3.7], None, -3.7 3.03 34.9 0.167 0.335 18.3 true;
    "IV.2" "right" 0.25 0.3 [1.16, 31.1], None, 1.16 2.95 38.7 0.215 0.256 13.8 false;
    "IV.3" "right" 0.3 0.5 [24.1], None, 24.1 3.14 24.6 0.226 0.379 14.9 false;
    "IV.4" "left" 0.15 0.3 [-13.9], None, -13.9 2.97 36.4 0.126 0.252 24.4 false;
    "IV.5" "left" 0.2 0.4 [-25.9], None, -25.9 3.08 22.0 0.145 0.29 22.7 true;
    "IV.6" "left" 0.3 0.25 [-34.3, -8.9], None, -8.9 2.95 36.4 0.253 0.212 12.3 true;
    "V.1" "auto" 0.15 0.2 [-29.9, 5.2], Some(12.7), 5.2 2.66 37.4 0.127 0.171 21.3 true;
    "V.2" "auto" 0.15 0.2 [-16.77, 13.32], Some(8.82), 13.32 2.93 36.8 0.127 0.169 24.4 true;
    "V.3" "auto" 0.2 0.5 [-30.5, 3.2], Some(8.3), 3.2 2.69 37.9 0.171 0.425 15.8 false;
    "V.4" "auto" 0.2 0.5 [-25.3, 9.2, 33.6], Some(84.4), 33.6 3.54 12.3 0.118 0.295 32.0 true;
    "V.5" "auto" 0.3 0.25 [-30.6, 3.3, 34.7], Some(71.6), 34.7 3.25 12.3 0.177 0.147 22.4 true;
    "V.6" "auto" 0.3 0.25 [-12.6, 18.3], Some(-27.4), -12.6 2.89 38.0 0.256 0.215 12.3 false;
};

/// Equal to three decimals, rounded or cut off, for a width that is printed to a tenth of a degree.
fn follows(greatest: f64, width: f64, printed: f64) -> bool {
    let [least, most] = [-0.05, 0.05].map(|off| greatest * law::e25(width + off, 70.0));
    // 0.001 covers both ways of getting to three decimals.
    printed >= least - 0.001 && printed <= most + 0.0005
}

/// S3 Tables IV and V, beside what the law makes of their inputs.
#[test]
fn tables_iv_and_v() {
    let geometry = kinect(0.25, 0.3);
    println!(
        "row   function  θ_r °   v m/s: paper  here | ω rad/s: paper  here | \
         time s: paper  here | heading °: paper  here"
    );
    let (mut speeds, mut rates, mut times, mut choices) = (0, 0, 0, 0);
    for row in TABLES {
        let share = f64::from(geometry.share((row.width as f32).to_radians()));
        let (speed, rate) = (row.speed_max * share, row.turn_rate_max * share);
        let time = law::time(row.length, row.heading, speed, rate);
        // A gesture takes the nearest to straight ahead on its side; else the waypoint decides.
        let aim = row.waypoint.unwrap_or(0.0);
        let chosen = law::nearest(row.candidates, aim).expect("a candidate");
        println!(
            "{:<5} {:<8} {:>6.1}   {:>12.3} {:>5.3} | {:>14.3} {:>5.3} | {:>13.1} {:>5.1} | \
             {:>16} {:>5}{}",
            row.name,
            row.function,
            row.width,
            row.speed,
            speed,
            row.turn_rate,
            rate,
            row.time,
            time,
            row.heading,
            chosen,
            if row.reproducible {
                ""
            } else {
                "   ω: ER-S3-18"
            }
        );
        // The core is the reference, here too.
        assert_abs_diff_eq!(share, law::e25(row.width, 70.0), epsilon = 2e-6);
        speeds += usize::from((speed - row.speed).abs() <= 0.001);
        let reached = follows(row.turn_rate_max, row.width, row.turn_rate);
        assert_eq!(reached, row.reproducible, "{}", row.name);
        assert!((rate - row.turn_rate).abs() <= 0.003, "{}", row.name);
        rates += usize::from(reached);
        times += usize::from((time - row.time).abs() <= 0.105);
        choices += usize::from(chosen == row.heading);
    }
    println!("v {speeds}/12, ω {rates}/12, time {times}/12, choice {choices}/12");
    assert_eq!((speeds, rates, times, choices), (12, 7, 12, 12));
}
