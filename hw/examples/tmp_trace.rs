use sidestep::avoid::Avoid;
use sidestep_hw::{
    config, demo,
    pilot::{Pilot, settings},
    session::Output,
};
use sidestep_sim::scenario::{Knobs, Scenario};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut a = std::env::args().skip(1);
    let name = a.next().unwrap();
    let seed: u64 = a.next().unwrap().parse()?;
    let from: u64 = a.next().unwrap().parse()?;
    let to: u64 = a.next().unwrap().parse()?;
    let toml: String = a
        .map(|a| {
            let (k, v) = a.split_once('=').unwrap();
            format!("{k} = {v}\n")
        })
        .collect();
    let config = config::parse(&toml, "arguments")?;
    let mut knobs = Knobs {
        courteous: false,
        seed,
        ..Knobs::default()
    };
    knobs.sonar_faults.dropout = 0.1;
    let s = if name == "c12" {
        use sidestep_sim::geometry::{Point, Pose};
        let mut s = Scenario::named("fig12-head-on", &knobs)?;
        let mut w = sidestep_sim::world::World::new();
        w.add_box(Pose::new(5.0, 0.65, 0.0), 14.0, 0.1)?;
        w.add_box(Pose::new(5.0, -0.65, 0.0), 14.0, 0.1)?;
        s.world = w;
        s.goal = Point::new(10.0, 0.0);
        s.time_limit_ms = 200_000;
        s
    } else {
        Scenario::named(&name, &knobs)?.randomised(seed, 0.8)?
    };
    let mut sim = s.simulate()?;
    let g = s.goal - s.start.position;
    let mut pilot = Pilot::<_, 16>::with_law(
        sidestep::escape::Escape::new(
            Avoid::new(config.core),
            config.core,
            sidestep_hw::base::ring::<16>(&config)?,
        ),
        config,
        [g.x as f32, g.y as f32],
        settings(&config, false, None),
        Box::new(std::io::sink()),
    )?;
    let mut now = 0;
    let mut last = 0;
    while now < s.time_limit_ms.min(to) {
        now += 10;
        sim.advance_to(now);
        let bytes = sim.robot_mut().transmit();
        if !bytes.is_empty() {
            pilot.receive(&bytes, now);
        }
        while let Some(o) = pilot.poll(now) {
            if let Output::Send(b) = o {
                sim.robot_mut().receive(&b);
            }
        }
        while let Some(e) = pilot.next_event() {
            println!("{e:?}");
        }
        if pilot.tally().arrived.is_some() {
            println!("arrived {now}");
            break;
        }
        if now >= from && pilot.tally().ticks != last {
            last = pilot.tally().ticks;
            if let Some(d) = pilot.latest() {
                let p = sim.trace().last().unwrap().pose;
                print!(
                    "{now} ({:.2},{:.2},{:.0}°) cl {:.2} v{} w{} {} {:?}",
                    p.position.x,
                    p.position.y,
                    p.heading.to_degrees(),
                    sim.clearance(),
                    d.command.speed(),
                    d.command.turn_rate(),
                    d.mode,
                    d.action
                );
                if let Some(st) = d.stop {
                    print!(" STOP {st}");
                }
                if let Some(l) = d.limit {
                    print!(" LIM {l}");
                }
                if let Some(v) = &d.view {
                    if let Some(o) = v.obstacle {
                        print!(
                            " obs d{:.2} dir{:.0}° {:?} v{:.2} vis{}",
                            o.distance.get(),
                            o.direction.minus(v.pose.heading).get().to_degrees(),
                            o.trend,
                            o.speed.value.get(),
                            o.visible
                        );
                    }
                    print!(" haz");
                    for h in &v.hazard {
                        print!(
                            " {}{}",
                            h.clearance,
                            if h.class == sidestep::view::Class::Still {
                                "s"
                            } else {
                                ""
                            }
                        );
                    }
                }
                println!();
            }
        }
    }
    let _ = demo::FIG12;
    Ok(())
}
