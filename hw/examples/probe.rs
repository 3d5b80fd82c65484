use sidestep::{
    avoid::Avoid,
    decide::{Decide, Settings},
    escape::Escape,
    law::Law,
};
use sidestep_hw::pilot::{Pilot, settings, usual_law};
use sidestep_hw::{base, config, demo};
use sidestep_sim::scenario::{Knobs, Scenario};
use std::collections::BTreeMap;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<String> = std::env::args().collect();
    let config = config::parse(a.get(6).map_or("", |s| s), "x")?;
    let ring = base::ring(&config)?;
    go(&a, "S1", &|| usual_law(config.core, ring))?;
    let s = Settings::usual(&config.core)?;
    go(&a, "S1+S2", &|| {
        Escape::new(
            Decide::new(Avoid::new(config.core), config.core, ring, s),
            config.core,
            ring,
        )
    })
}
fn go<L: Law<16>>(
    a: &[String],
    name: &str,
    law: &dyn Fn() -> L,
) -> Result<(), Box<dyn std::error::Error>> {
    let f: f64 = a[2].parse()?;
    let m: f64 = a[3].parse()?;
    let seeds: u64 = a[4].parse()?;
    let mut knobs = Knobs::default();
    knobs.sonar_faults.false_echo = f;
    knobs.sonar_faults.dropout = m;
    let config = config::parse(a.get(6).map_or("", |s| s), "x")?;
    let pspeed: f64 = a.get(5).map_or(0.8, |s| s.parse().unwrap());
    let mut modes: BTreeMap<&str, u64> = BTreeMap::new();
    let mut stops: BTreeMap<String, u64> = BTreeMap::new();
    let (mut ticks, mut arrived, mut travelled, mut turned) = (0u64, 0, 0.0, 0.0);
    for seed in 0..seeds {
        knobs.seed = seed;
        let s = Scenario::named(&a[1], &knobs)?.randomised(seed, pspeed)?;
        let mut sim = s.simulate()?;
        let mut pilot = Pilot::<_, 16>::with_law(
            law(),
            config,
            demo::goal_from_start(&s),
            settings(&config, false, None),
            Box::new(std::io::sink()),
        )?;
        let mut now = 0;
        let mut last = 0;
        let mut h = 0.0;
        while now < s.time_limit_ms {
            now += sidestep_sim::STEP_MS;
            sim.advance_to(now);
            let b = sim.robot_mut().transmit();
            if !b.is_empty() {
                pilot.receive(&b, now);
            }
            while let Some(o) = pilot.poll(now) {
                if let sidestep_hw::session::Output::Send(b) = o {
                    sim.robot_mut().receive(&b);
                }
            }
            while pilot.next_event().is_some() {}
            if pilot.tally().ticks > last {
                last = pilot.tally().ticks;
                ticks += 1;
                let d = pilot.latest().unwrap();
                *modes.entry(d.mode).or_default() += 1;
                *stops
                    .entry(d.stop.map_or("-".into(), |r| r.row().cause.to_owned()))
                    .or_default() += 1;
                if let Some(v) = &d.view {
                    let x = v.pose.heading.get();
                    let dd: f32 = x - h;
                    turned += f64::from(dd.sin().abs());
                    h = x;
                }
            }
            if pilot.tally().arrived.is_some() {
                arrived += 1;
                break;
            }
        }
        travelled += sim.outcome().travelled;
    }
    println!(
        "{name} {} f={f} m={m}: arrived {arrived}/{seeds}, ticks {ticks}, travelled {:.2} m/run, turned {:.1} rad/run",
        a[1],
        travelled / seeds as f64,
        turned / seeds as f64
    );
    println!(
        "  modes {:?}",
        modes
            .iter()
            .map(|(k, v)| (*k, (1000 * v / ticks) as f64 / 10.0))
            .collect::<Vec<_>>()
    );
    println!(
        "  stops {:?}",
        stops
            .iter()
            .map(|(k, v)| (k.clone(), (1000 * v / ticks) as f64 / 10.0))
            .collect::<Vec<_>>()
    );
    Ok(())
}
