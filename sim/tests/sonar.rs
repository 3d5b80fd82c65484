//! Readings: exact without noise, wrong exactly as asked.

use sidestep::arcos::{NO_ECHO_RANGE, P3DX_SONARS};
use sidestep_sim::World;
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::sonar::{Failure, Faults, Parameters, Ring};

const ORIGIN: fn() -> Pose = || Pose::new(0.0, 0.0, 0.0);

const EXACT: fn() -> Parameters = || Parameters {
    noise: 0.0,
    ..Parameters::default()
};

fn ring(parameters: Parameters, faults: Faults, seed: u64) -> Ring {
    let mut ring = Ring::new(&P3DX_SONARS, parameters, seed).unwrap();
    ring.set_faults(faults).unwrap();
    ring
}

/// A wall across the way, `distance` (m) from the face of the sonars 3 and 4.
fn wall(distance: f64) -> World {
    let mut world = World::new();
    let x = 0.166 + distance;
    world
        .add_wall(Point::new(x, -20.0), Point::new(x, 20.0))
        .unwrap();
    world
}

#[test]
fn readings_are_whole_millimetres_of_the_exact_range() {
    let mut ring = ring(EXACT(), Faults::default(), 0);
    let mut read = |world: &World, sonar| ring.measure(sonar, world, &ORIGIN()).unwrap();
    assert_eq!(read(&wall(1.0), 3), 1000);
    assert_eq!(read(&wall(1.2344), 4), 1234);
    // Sonar 2 looks along 30° from (148, 78): its edge at 15° meets x = 1166 mm.
    assert_eq!(
        read(&wall(1.0), 2),
        ((1.166 - 0.148) / 15_f64.to_radians().cos() * 1000.0_f64).round() as u16
    );
    assert_eq!(read(&wall(4.999), 3), 4999);
    assert_eq!(read(&wall(5.001), 3), NO_ECHO_RANGE);
    assert_eq!(read(&wall(1.0), 11), NO_ECHO_RANGE);
    assert_eq!(ring.measure(16, &wall(1.0), &ORIGIN()), None);
}

#[test]
fn within_the_blanking_distance_readings_are_below_it() {
    let mut ring = ring(EXACT(), Faults::default(), 0);
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..1000 {
        let reading = ring.measure(3, &wall(0.02), &ORIGIN()).unwrap();
        assert!(reading <= 30);
        seen.insert(reading);
        assert_eq!(ring.measure(3, &wall(0.031), &ORIGIN()), Some(31));
    }
    // Any of them.
    assert!(seen.len() > 25, "{seen:?}");
}

#[test]
fn noise_does_not_carry_a_reading_beyond_the_reach_nor_from_one_sonar_to_the_next() {
    let parameters = Parameters {
        noise: 0.02,
        ..Parameters::default()
    };
    let mut ring = ring(parameters, Faults::default(), 3);
    let mut lost = 0;
    let mut same = 0;
    for _ in 0..1000 {
        let left = ring.measure(3, &wall(4.99), &ORIGIN()).unwrap();
        let right = ring.measure(4, &wall(4.99), &ORIGIN()).unwrap();
        assert!(left <= NO_ECHO_RANGE && right <= NO_ECHO_RANGE);
        lost += u32::from(left == NO_ECHO_RANGE);
        same += u32::from(left == right && left < NO_ECHO_RANGE);
    }
    assert!((350..650).contains(&lost), "{lost}");
    assert!(same < 20, "{same}");
}

#[test]
fn noise_has_the_deviation_asked_for() {
    let parameters = Parameters {
        noise: 0.02,
        ..Parameters::default()
    };
    let mut ring = ring(parameters, Faults::default(), 3);
    let world = wall(2.0);
    let errors: Vec<f64> = (0..20_000)
        .map(|_| f64::from(ring.measure(3, &world, &ORIGIN()).unwrap()) / 2000.0 - 1.0)
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let variance = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / errors.len() as f64;
    assert!(mean.abs() < 0.0006, "{mean}");
    assert!(
        (variance.sqrt() - 0.02).abs() < 0.0005,
        "{}",
        variance.sqrt()
    );
}

#[test]
fn faults_come_as_often_as_asked_for() {
    const PINGS: u32 = 20_000;
    let count = |faults: Faults, wrong: fn(u16) -> bool| {
        let mut ring = ring(EXACT(), faults, 5);
        let world = wall(2.0);
        (0..PINGS)
            .filter(|_| wrong(ring.measure(3, &world, &ORIGIN()).unwrap()))
            .count() as f64
            / f64::from(PINGS)
    };
    let lost = count(
        Faults {
            dropout: 0.2,
            ..Faults::default()
        },
        |r| r == NO_ECHO_RANGE,
    );
    assert!((lost - 0.2).abs() < 0.01, "{lost}");
    let zero = count(
        Faults {
            zero: 0.1,
            ..Faults::default()
        },
        |r| r == 0,
    );
    assert!((zero - 0.1).abs() < 0.01, "{zero}");
    // A false echo is shorter, and as often in the nearer half of the range as in the farther.
    let false_echo = Faults {
        false_echo: 0.3,
        ..Faults::default()
    };
    let shorter = count(false_echo, |r| r < 2000);
    assert!((shorter - 0.3).abs() < 0.01, "{shorter}");
    let near = count(false_echo, |r| r < 1000);
    assert!((near - 0.15).abs() < 0.01, "{near}");
    assert_eq!(count(false_echo, |r| r > 2000), 0.0);
}

#[test]
fn broken_sonars_stay_broken_and_leave_the_others_alone() {
    let world = wall(1.0);
    let mut sound = ring(Parameters::default(), Faults::default(), 9);
    let mut broken = sound.clone();
    for (index, failure) in [
        (2, Failure::Silent),
        (3, Failure::Deaf),
        (4, Failure::Stuck(777)),
    ] {
        let failure = Some(failure);
        broken
            .set_faults_of(
                index,
                Faults {
                    failure,
                    ..Faults::default()
                },
            )
            .unwrap();
    }
    for _ in 0..100 {
        for index in 0..16 {
            let reading = broken.measure(index, &world, &ORIGIN());
            let expected = sound.measure(index, &world, &ORIGIN());
            match index {
                2 => assert_eq!(reading, None),
                3 => assert_eq!(reading, Some(NO_ECHO_RANGE)),
                4 => assert_eq!(reading, Some(777)),
                _ => assert_eq!(reading, expected),
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let mut ring = Ring::new(&P3DX_SONARS, Parameters::default(), 0).unwrap();
    for dropout in [-0.1, 1.1, f64::NAN] {
        assert!(
            ring.set_faults(Faults {
                dropout,
                ..Faults::default()
            })
            .is_err()
        );
    }
    assert!(ring.set_faults_of(16, Faults::default()).is_err());
    for parameters in [
        Parameters {
            half_angle: 1.6,
            ..EXACT()
        },
        Parameters {
            range: 5.1,
            ..EXACT()
        },
        Parameters {
            range: 0.02,
            ..EXACT()
        },
        Parameters {
            noise: -0.1,
            ..EXACT()
        },
        Parameters {
            blanking: f64::NAN,
            ..EXACT()
        },
    ] {
        assert!(Ring::new(&P3DX_SONARS, parameters, 0).is_err());
    }
}
