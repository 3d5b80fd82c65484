//! A bad line between host and robot, in virtual time.
mod common;
use common::*;
use sidestep::avoid::Avoid;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::log::Halt;

#[test]
fn measure_mangled() {
    let config = RobotConfig::default();
    for patience in [10_000, 150] {
    for dir in 0..2 {
    for kind in 0..4 { for p in [0.02, 0.1, 0.3] {
        let (mut contacts, mut arrived, mut rej) = (0, 0, 0);
        let mut lost = 0; let mut t = 0;
        for seed in 0..200 {
            let scenario = inconsiderate("head-on-80", 0.1).randomised(seed, 0.8).unwrap();
            let mut rig = Rig::new(&scenario, &config, Avoid::new(config.core));
            let m = |seed: u64| -> Mangle { let mut r = Random(seed); Box::new(move |mut b: Vec<u8>, now| {
                if b.is_empty() || now < 1000 || !r.chance(p) { return b; }
                match kind {
                    0 => { let at = r.below(b.len()+1); let n = 1 + r.below(20); for _ in 0..n { b.insert(at, r.bits() as u8); } }
                    1 => { let k = r.below(b.len()); b.truncate(k); }
                    2 => { let k = r.below(b.len()); b[k] ^= 1 << r.below(8); }
                    _ => b.clear(),
                }
                b
            })};
            if dir == 0 { rig.to_host = m(seed); } else { rig.to_robot = m(seed + 1000); }
            let mut last = (0, 0);
            while rig.now() < 60000 && rig.pilot.tally().arrived.is_none() {
                rig.step();
                if rig.pilot.tally().ticks != last.0 { last = (rig.pilot.tally().ticks, rig.now()); }
                if rig.now() >= last.1 + patience { let n = rig.now(); rig.pilot.halt(Halt::LinkLost, n); }
            }
            arrived += u32::from(rig.pilot.tally().arrived.is_some());
            t += rig.now();
            contacts += moving_contacts(&rig.simulation.outcome());
            rej += rig.pilot.tally().rejected;
            lost += rig.events.iter().filter(|e| e.1.contains("lost")).count();
        }
        println!("patience {patience} dir {dir} kind {kind} p {p}: contacts {contacts} arrived {arrived} in {} rejected {rej} lost {lost}", t/200);
    }}}}
}
