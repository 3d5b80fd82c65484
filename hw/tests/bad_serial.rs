//! A bad line between host and robot, in virtual time.
mod common;
use common::*;
use sidestep::avoid::Avoid;
use sidestep_hw::config::RobotConfig;

#[test]
fn measure_dead() {
    let config = RobotConfig::default();
    for (kind, to_host, to_robot) in [("both", true, true), ("to host", true, false), ("to robot", false, true)] {
        for (name, limit) in [("fig12-head-on", 0.4), ("fig12-crossing", 0.4), ("fig12-from-side", 0.4), ("head-on-80", 0.8)] {
            let (mut contacts, mut runs, mut at_rest) = (0, 0, 0);
            let mut late = 0;
            for seed in 0..200 {
                let scenario = inconsiderate(name, 0.1).randomised(seed, limit).unwrap();
                let mut rig = Rig::new(&scenario, &config, Avoid::new(config.core));
                let mut random = Random(seed);
                let at = 2000 + (random.unit() * 12000.0) as u64;
                if rig.drive(at) { continue; }
                let before = moving_contacts(&rig.simulation.outcome());
                if to_host { rig.to_host = Box::new(|_, _| Vec::new()); }
                if to_robot { rig.to_robot = Box::new(|_, _| Vec::new()); }
                let moving = rig.speed() > 0.0;
                rig.wait(3000);
                if !rig.at_rest() { late += 1; }
                runs += u32::from(moving);
                contacts += moving_contacts(&rig.simulation.outcome()) - before;
                at_rest += rig.simulation.outcome().contacts_at_rest.people;
            }
            println!("{kind} {name}: {runs} moving, contacts {contacts}, not at rest {late}, at rest {at_rest}");
        }
    }
}

#[test]
fn measure_mangled() {
    let config = RobotConfig::default();
    for kind in 0..3 { for p in [0.02, 0.1, 0.3] {
        let (mut contacts, mut arrived, mut rej) = (0, 0, 0);
        let mut lost = 0;
        for seed in 0..100 {
            let scenario = inconsiderate("head-on-80", 0.1).randomised(seed, 0.8).unwrap();
            let mut rig = Rig::new(&scenario, &config, Avoid::new(config.core));
            let m = |seed: u64| -> Mangle { let mut r = Random(seed); Box::new(move |mut b: Vec<u8>, _| {
                if b.is_empty() || !r.chance(p) { return b; }
                match kind {
                    0 => { let at = r.below(b.len()+1); let n = 1 + r.below(20); for _ in 0..n { b.insert(at, r.bits() as u8); } }
                    1 => { let k = r.below(b.len()); b.truncate(k); }
                    _ => { let k = r.below(b.len()); b[k] ^= 1 << r.below(8); }
                }
                b
            })};
            rig.to_host = m(seed); rig.to_robot = m(seed + 1000);
            arrived += u32::from(rig.drive(60000));
            contacts += moving_contacts(&rig.simulation.outcome());
            rej += rig.pilot.tally().rejected;
            lost += rig.events.iter().filter(|e| e.1.contains("lost")).count();
            rig.finish();
        }
        println!("kind {kind} p {p}: contacts {contacts} arrived {arrived} rejected {rej} lost {lost}");
    }}
}
