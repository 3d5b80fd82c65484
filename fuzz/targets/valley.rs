//! Bytes as people, robots and sensors: every function of `valley`.

use super::bytes::Bytes;
use sidestep::gesture::PEOPLE_MAX;
use sidestep::quantity::Speed;
use sidestep::valley::{self, Geometry, Heading, Person, Scene, Side};
use sidestep_spec::valley as law;

/// Somebody, if the numbers are a person's.
fn any_person(bytes: &mut Bytes) -> Option<Person> {
    let at = bytes.truth();
    let numbers = [bytes.number(), bytes.number(), bytes.number()];
    let [one, other, radius] = numbers;
    let person = if at {
        Person::at(other, one, radius)
    } else {
        Person::new(one, other, radius)
    };
    person.ok()
}

/// A person with this share of the radius, 5 cm at least.
fn thinner(person: &Person, share: f32) -> Person {
    let radius = 0.05 + (person.radius() - 0.05) * share;
    Person::at(person.depth(), -person.lateral(), radius).unwrap_or(*person)
}

/// Which regions hold an accepted valley.
fn accepted(geometry: &Geometry, scene: &Scene) -> [bool; PEOPLE_MAX + 1] {
    let valleys = geometry.valleys(scene);
    std::array::from_fn(|index| valleys.get(index).is_some())
}

/// Calls everything. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let numbers = [bytes.number(), bytes.number(), bytes.number()];
    let geometry = Geometry::new(numbers[0], numbers[1], numbers[2]);
    let [radius, distance] = match geometry {
        Ok(_) => [numbers[0], numbers[1]],
        Err(_) => [0.25, 0.3],
    };
    let s3 = Geometry::new(0.25, 0.3, 35_f32.to_radians()).expect("S3's");
    let geometry = geometry.unwrap_or(s3);
    let count = usize::from(bytes.u8() % 8);
    let people: Vec<Person> = (0..count).filter_map(|_| any_person(&mut bytes)).collect();
    let Ok(scene) = Scene::new(&people) else {
        assert!(people.len() > PEOPLE_MAX);
        return;
    };
    assert_eq!(scene.may_be_more(), people.len() == PEOPLE_MAX);
    let mut other = people.clone();
    other.reverse();
    let half = other.len() / 2;
    other.rotate_left(half);
    let other = Scene::new(&other).expect("as many");
    assert!(law::same_for_any_order(&scene, &other));
    assert!(law::same_for_any_order(
        &geometry.valleys(&scene),
        &geometry.valleys(&other)
    ));

    for index in 0..=PEOPLE_MAX + 1 {
        let Some(region) = geometry.region(&scene, index) else {
            assert!(people.is_empty() || index > people.len());
            continue;
        };
        assert!(law::decided_by_width(
            region.is_wide_enough(),
            region.available,
            region.least
        ));
        let valley = geometry.valley(&scene, index);
        assert!(valley.is_none() || region.is_wide_enough());
    }
    let valleys = geometry.valleys(&scene);
    for valley in valleys.iter() {
        let heading = valley.heading;
        assert!(law::is_defined(
            heading.sine(),
            geometry.view_sine(),
            valley.length
        ));
        assert!(geometry.admits(&scene, heading, valley.length));
        for person in &people {
            assert!(law::keeps_clear(
                [person.lateral(), person.depth()],
                geometry.clearance(person) + valley::ROUNDING,
                [heading.sine(), heading.cosine()],
                valley.length,
            ));
            let outside = law::Geometry {
                robot_radius: radius.into(),
                safety_distance: distance.into(),
                view_half_angle_deg: 35.0,
            };
            let reference = law::Person {
                lateral: person.lateral().into(),
                range: f64::from(person.lateral()).hypot(person.depth().into()),
                radius: person.radius().into(),
            };
            let degrees = f64::from(heading.sine()).asin().to_degrees();
            assert!(law::path_is_clear(
                &reference,
                &outside,
                degrees,
                valley.length.into()
            ));
        }
        assert!(valley.turn_rate(&geometry, 0.5).abs() <= 0.5);
        assert!(valley.speed(&geometry, Speed::MAX) <= Speed::MAX);
    }

    let aim = bytes.angle().get();
    let angles: Vec<f32> = valleys.iter().map(|v| v.heading.angle()).collect();
    match valleys.by_waypoint(aim) {
        Some(chosen) => assert!(law::is_nearest(chosen.heading.angle(), aim, &angles)),
        None => assert!(valleys.is_empty()),
    }
    let master = usize::from(bytes.u8());
    for side in [Side::Left, Side::Right] {
        let there: Vec<f32> = valleys
            .iter()
            .filter(|valley| (valley.index <= master) == (side == Side::Left))
            .map(|valley| valley.heading.angle())
            .collect();
        match valleys.by_side(side, master) {
            Some(chosen) => assert!(law::is_nearest(chosen.heading.angle(), 0.0, &there)),
            None => assert!(there.is_empty()),
        }
    }

    // Thinner people take no valley away, as long as who is left of whom does not change.
    let mut places: Vec<f32> = people.iter().map(Person::lateral).collect();
    places.sort_by(f32::total_cmp);
    if places.windows(2).all(|pair| pair[0] < pair[1]) {
        let again: Vec<Person> = people.iter().map(|p| thinner(p, 1.0)).collect();
        let thin: Vec<Person> = again.iter().map(|p| thinner(p, bytes.share())).collect();
        let [was, is] = [again, thin].map(|people| {
            let scene = Scene::new(&people).expect("as many");
            accepted(&geometry, &scene)
        });
        assert!(law::none_taken_away(&was, &is));
    }

    let (one, two) = (bytes.number(), bytes.number());
    let [slow, fast] = [one.min(two), one.max(two)].map(|width| geometry.share(width));
    assert!(law::is_share(slow) && law::is_share(fast));
    assert!(law::no_slower(slow, fast) || one.is_nan() || two.is_nan());
    let heading = Heading::new(one);
    assert!(heading.sine().abs() <= 1.0 && (0.0..=1.0).contains(&heading.cosine()));
}
