use sidestep::avoid::Avoid;
use sidestep_hw::{config, demo};
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::scenario::{Knobs, Scenario};
use sidestep_sim::world::World;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let toml: String = std::env::args()
        .skip(1)
        .map(|a| {
            let (k, v) = a.split_once('=').unwrap();
            format!("{k} = {v}\n")
        })
        .collect();
    let config = config::parse(&toml, "arguments")?;
    for width in [1.2, 1.3, 1.5, 2.0] {
        let knobs = Knobs {
            courteous: false,
            seed: 3,
            ..Knobs::default()
        };
        let mut s = Scenario::named("fig12-head-on", &knobs)?;
        let mut w = World::new();
        w.add_box(Pose::new(5.0, width / 2.0 + 0.05, 0.0), 14.0, 0.1)?;
        w.add_box(Pose::new(5.0, -width / 2.0 - 0.05, 0.0), 14.0, 0.1)?;
        s.world = w;
        s.goal = Point::new(10.0, 0.0);
        s.time_limit_ms = 200_000;
        let (summary, d) = demo::run_in_memory(
            &s,
            &config,
            sidestep::escape::Escape::new(
                Avoid::new(config.core),
                config.core,
                sidestep_hw::base::ring::<16>(&config)?,
            ),
        )?;
        println!(
            "{width}: {:?} arrived {:?} travelled {:.2} stops {:?}",
            summary.ending, summary.tally.arrived, summary.outcome.travelled, summary.tally.stops
        );
        let _ = d;
    }
    Ok(())
}
