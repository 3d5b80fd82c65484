//! S2's worked example (E23 to E30): the numbers that the paper prints, the correct ones, and what the
//! core computes; and the same decision with the losses that this library uses.
//!
//! `cargo run --example worked_decision`

use sidestep::config::Config;
use sidestep::decide::{Belief, LossTable, Settings};
use sidestep::preset;
use sidestep::quantity::Length;
use sidestep_spec::decide as law;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (likelihood, prior) = ([0.7, 0.3], [0.8, 0.2]);
    println!("p(z|obstacle) = 0.7, p(z|nothing) = 0.3; p(obstacle) = 0.8, p(nothing) = 0.2\n");
    let correct = law::e21(&likelihood, &prior).ok_or("no posterior")?;
    let core = Belief::from_weights(&prior.map(|p| p as f32))?;
    let core = core.updated(&likelihood.map(|l| l as f32))?;
    let row = |name: &str, printed: f64, correct: f64, core: f32| {
        println!("{name:<30} {printed:>9.3} {correct:>10.6} {core:>10.6}");
    };
    println!(
        "{:<30} {:>9} {:>10} {:>10}",
        "", "printed", "correct", "core"
    );
    let [first, second] = law::POSTERIOR_PRINTED;
    row("E26 p(obstacle|z)", first, correct[0], core.probability(0));
    row("E28 p(nothing|z)", second, correct[1], core.probability(1));
    let sum = core.probability(0) + core.probability(1);
    row(
        "    their sum",
        first + second,
        correct[0] + correct[1],
        sum,
    );
    let [maneuver, stop] = law::LOSSES_PRINTED;
    let table = law::TABLE_2.map(|row| row.to_vec());
    let losses = law::e22(&table, &correct);
    let expected = LossTable::TABLE_2.expected_seconds(&core);
    row("E29 B(maneuver), s", maneuver, losses[0], expected[0]);
    row("E30 B(stop), s", stop, losses[1], expected[1]);
    let difference = expected[1] - expected[0];
    row(
        "    their difference",
        stop - maneuver,
        losses[1] - losses[0],
        difference,
    );

    println!("\nTable 2, whatever is believed:");
    println!(
        "{:>12} {:>12} {:>9} {:>12}",
        "p(obstacle)", "B(maneuver)", "B(stop)", "difference"
    );
    for percent in [0_u8, 25, 50, 75, 100] {
        let p = f32::from(percent) / 100.0;
        let [maneuver, stop] =
            LossTable::TABLE_2.expected_seconds(&Belief::from_weights(&[p, 1.0 - p])?);
        println!(
            "{p:>12} {maneuver:>12.3} {stop:>9.3} {:>12.3}",
            stop - maneuver
        );
    }
    let refused = LossTable::new(&law::TABLE_2.map(|row| row.map(|loss| loss as f32)));
    if let Err(refused) = refused {
        println!("so the table is refused unless asked for: {refused}");
    }

    let settings = Settings::usual(&Config::new(preset::SRIKANDI_II_2011)?)?;
    println!(
        "\nthe losses used here, by distance, for the paper's posterior and for a doubtful echo:"
    );
    println!(
        "{:>9} {:>6} {:>34} {:>10}",
        "distance", "p", "B(continue), B(maneuver), B(stop)", "response"
    );
    for centimetres in [120_u8, 100, 80, 60, 50, 45, 40] {
        for belief in [core, Belief::from_weights(&[0.1, 0.9])?] {
            let distance = Length::metres(f32::from(centimetres) / 100.0)?;
            let losses = settings.loss().at(distance).expected_seconds(&belief);
            let losses = losses.map(|loss| format!("{loss:.2}")).join(", ");
            println!(
                "{:>6} cm {:>6.2} {losses:>34} {:>10}",
                centimetres,
                belief.probability(0),
                format!("{:?}", settings.respond(&belief, distance)).to_lowercase(),
            );
        }
    }
    Ok(())
}
