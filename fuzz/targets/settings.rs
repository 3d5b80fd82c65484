//! Every configuration that can be constructed, and rings of sonars.

use sidestep::arcos::P3DX_SONARS;
use sidestep::config::{Config, FIELDS, Parameters};
use sidestep::ring::{Placement, Ring};

/// A number for each field, saying where in its range it lies: 0 is the least, 1 the greatest.
pub type Shares = [f32; FIELDS.len()];

/// The share `share` of the way from `least` to `greatest`.
fn between(share: f32, least: f32, greatest: f32) -> f32 {
    (least + (greatest - least) * share).clamp(least, greatest)
}

/// The configuration at these shares. Where the range of a field depends on another field, it is
/// a share of that range: every configuration that can be constructed has its shares, and all
/// shares from 0 to 1 give one.
///
/// # Panics
/// If a configuration that is within all ranges is refused.
#[must_use]
pub fn config(shares: &Shares) -> Config {
    let mut values = *shares;
    for (value, field) in values.iter_mut().zip(&FIELDS) {
        *value = between(*value, field.min, field.max);
        if field.whole {
            *value = value.round();
        }
    }
    let at = Parameters::from_values(*shares);
    let mut p = Parameters::from_values(values);
    p.safe_distance = between(at.safe_distance, 0.1, p.sonar_range_max.min(10.0));
    p.near_distance = between(at.near_distance, 0.05, p.safe_distance);
    p.min_distance = between(at.min_distance, 0.03, p.near_distance.min(5.0));
    p.sonar_range_min = between(at.sonar_range_min, 0.0, p.min_distance.min(0.5));
    p.turn_distance = between(at.turn_distance, 0.01, (2.0 * p.min_distance).min(5.0));
    p.cruise_speed = between(at.cruise_speed, 0.01, p.speed_max);
    p.braking_share = between(at.braking_share, (0.1 / p.braking).max(0.1), 1.0);
    p.still_speed_max = between(at.still_speed_max, 0.0, p.obstacle_speed_max);
    p.still_speed_max_turning = between(
        at.still_speed_max_turning,
        p.still_speed_max,
        p.obstacle_speed_max,
    );
    Config::new(p).expect("within every range")
}

/// The sonars of a robot with 1, 3, 8 or 16 of them: ahead; ahead, left and right as S1 has them; the
/// front array of a Pioneer; its whole ring.
///
/// # Panics
/// If `N` is none of these.
#[must_use]
pub fn placements<const N: usize>() -> [Placement; N] {
    let pioneer = |i: usize| {
        let at = P3DX_SONARS[i];
        Placement::from_mm_deg(at.x_mm, at.y_mm, at.heading_deg)
    };
    let three = [(200, 0, 0), (100, 180, 60), (100, -180, -60)];
    std::array::from_fn(|i| match N {
        1 | 3 => {
            let (x, y, heading) = three[i];
            Placement::from_mm_deg(x, y, heading)
        }
        8 | 16 => pioneer(i),
        _ => panic!("no ring of {N} sonars"),
    })
}

/// The ring of [`placements`], and the configuration it is good with. See [`fitted_to`].
#[must_use]
pub fn fitted<const N: usize>(config: &Config) -> (Config, Ring<N>) {
    fitted_to(&placements(), config)
}

/// A ring, and the configuration changed as little as it takes for the ring to be good with it: every
/// configuration that goes with the ring stays as it is.
///
/// # Panics
/// If the ring is refused for what no change mends.
#[must_use]
pub fn fitted_to<const N: usize>(
    placements: &[Placement; N],
    config: &Config,
) -> (Config, Ring<N>) {
    let mut p = *config.parameters();
    // Each turn mends what is named, or halves what asks for more than sonars see.
    for _ in 0..100 {
        let config = Config::new(p).expect("within every range");
        match Ring::new(placements, &config) {
            Ok(ring) => return (config, ring),
            Err(refused) if refused.field == "safe_distance" => {
                if refused.min <= 10.0 {
                    p.safe_distance = refused.min;
                    p.sonar_range_max = p.sonar_range_max.max(refused.min);
                } else {
                    p.cruise_speed = (p.cruise_speed / 2.0).max(0.01);
                    p.reaction_time = (p.reaction_time / 2.0).max(0.02);
                    p.obstacle_speed_max /= 2.0;
                    p.still_speed_max = p.still_speed_max.min(p.obstacle_speed_max);
                    p.still_speed_max_turning = p.still_speed_max_turning.min(p.obstacle_speed_max);
                }
            }
            Err(refused) => {
                assert_eq!(refused.field, "gap between sonars ahead");
                p.blind_angle_max = refused.value;
            }
        }
    }
    panic!("no ring of {N} sonars for {config:?}");
}
