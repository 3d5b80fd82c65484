//! The guard in exact arithmetic: what a command needs, from the model of the law book alone.

use sidestep::ring::Closing;
use sidestep::shield::{Limits, Motion, Twist};
use sidestep::view::Hazard;
use sidestep_spec::shield::Model;

/// The model that a hazard falls under.
#[must_use]
pub fn model(limits: &Limits, hazard: &Hazard) -> Model {
    Model {
        acceleration: f64::from(limits.acceleration()),
        braking: f64::from(limits.braking()),
        reaction_time: f64::from(limits.reaction_time()),
        obstacle_speed: f64::from(limits.class_speed(hazard.class)),
    }
}

/// The same for a turn: if that outlasts the driving, what stands still has a bound of its own.
fn turning(limits: &Limits, hazard: &Hazard, course: &Course) -> Model {
    let model = model(limits, hazard);
    // The code rounds the time to rest up, to the next of 64 steps that it has it for.
    let top = limits.speed_max() + 2 * limits.speed_gain() + limits.speed_error();
    let step = 1000.0 * f64::from(top) / 64.0 / model.braking + 2.0;
    let outlasts = course.slowing(limits) > course.time - model.reaction_time + step;
    let bound = limits.class_speed_turning(hazard.class, outlasts);
    Model {
        obstacle_speed: f64::from(bound),
        ..model
    }
}

/// What a command comes to: the greatest speeds forward and backward until the robot brakes, mm/s,
/// the time to rest, ms, and the turn rate until then, mrad/s.
struct Course {
    fastest: [f64; 2],
    time: f64,
    turn_rate: f64,
}

impl Course {
    /// How long the turn takes to end, ms: |ω|/α.
    fn slowing(&self, limits: &Limits) -> f64 {
        1000.0 * self.turn_rate / f64::from(limits.turn_acceleration())
    }
}

fn course(model: &Model, motion: &Motion, twist: Twist) -> Course {
    let mut fastest = [0.0_f64; 2];
    fastest[usize::from(motion.backward)] = f64::from(motion.speed);
    if twist.speed != 0 {
        // One gain above what it is told.
        let told = f64::from(twist.speed.abs()) + model.acceleration * model.reaction_time / 1000.0;
        let way = &mut fastest[usize::from(twist.speed < 0)];
        *way = way.max(told);
    }
    let time = model.time_to_rest(fastest[0].max(fastest[1]));
    let turn_rate = f64::from(twist.turn_rate.abs().max(motion.turn_rate));
    Course {
        fastest,
        time,
        turn_rate,
    }
}

/// What the robot's own ways and the thing's take of the clearance, mm, if all ends in `time` ms.
fn taken(model: &Model, hazard: &Hazard, closing: &Closing, course: &Course, time: f64) -> f64 {
    let turned = f64::from(hazard.turned) + course.turn_rate * course.time / 1000.0;
    let own: f64 = [closing.ahead, closing.back]
        .into_iter()
        .enumerate()
        .map(|(i, cosine)| {
            let share = (f64::from(cosine) + turned).clamp(0.0, 1000.0) / 1000.0;
            let rest = match course.fastest[i] {
                0.0 => 0.0,
                fastest => model.way_to_rest(fastest),
            };
            share * (f64::from(hazard.way[i]) + rest)
        })
        .sum();
    own + model.obstacle_speed * (f64::from(hazard.age) + time) / 1000.0
}

/// Whether there is room for a command, exactly: SH.3, and SH.6 for the turn.
#[must_use]
pub fn has_room(
    limits: &Limits,
    hazard: &Hazard,
    closing: &Closing,
    motion: &Motion,
    twist: Twist,
) -> bool {
    let model = model(limits, hazard);
    let course = course(&model, motion, twist);
    let clearance = f64::from(hazard.clearance);
    let driving = taken(&model, hazard, closing, &course, course.time);
    let time = model.reaction_time + course.slowing(limits);
    let turning = taken(
        &turning(limits, hazard, &course),
        hazard,
        closing,
        &course,
        time,
    );
    // The last bits of sums of a few terms.
    let needed = driving.max(turning);
    needed <= clearance + 1e-9 * needed
}

/// For a turn: the speed in mm/s that the thing may have, and what is left of the clearance, in
/// thousandths of a millimetre, once the robot's own ways and the age are taken off.
#[must_use]
pub fn left_for_turn(
    limits: &Limits,
    hazard: &Hazard,
    closing: &Closing,
    motion: &Motion,
    twist: Twist,
) -> (i32, i64) {
    let course = course(&model(limits, hazard), motion, twist);
    let model = turning(limits, hazard, &course);
    let taken = taken(&model, hazard, closing, &course, 0.0);
    let left = ((f64::from(hazard.clearance) - taken) * 1000.0).ceil() as i64;
    (model.obstacle_speed as i32, left)
}
