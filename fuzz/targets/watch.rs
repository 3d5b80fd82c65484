//! A controller with someone watching: every tick is judged by the predicates of the law book.

use super::reference::{has_room, left_for_turn};
use sidestep::config::Config;
use sidestep::controller::{Controller, Decision};
use sidestep::decide::SecondLook;
use sidestep::failsafe::{Action, StopReason};
use sidestep::law::{Advice, Law};
use sidestep::observation::{Observation, SonarReading};
use sidestep::quantity::Instant;
use sidestep::ring::Ring;
use sidestep::shield::{Command, Guard, Limits, Motion, Twist};
use sidestep::view::{Class, Hazard, View};
use sidestep_spec::{avoid, failsafe, shield, view as belief};
use std::cell::Cell;

/// A law that advises what it is told to, whatever it sees.
#[derive(Clone, Debug)]
pub struct Told {
    /// What it will advise.
    pub advice: Cell<Advice>,
}

impl Told {
    /// A law that will advise this.
    #[must_use]
    pub const fn new(advice: Advice) -> Self {
        Self {
            advice: Cell::new(advice),
        }
    }
}

impl<const N: usize> Law<N> for Told {
    fn advise(&mut self, _view: &View<N>) -> Advice {
        self.advice.get()
    }

    fn mode(&self) -> &'static str {
        "told"
    }
}

/// A controller, and what a bystander remembers of it.
#[derive(Clone, Debug)]
pub struct Watched<L, const N: usize> {
    /// The controller.
    pub controller: Controller<L, N>,
    config: Config,
    ring: Ring<N>,
    /// Which readings count. It is the controller's code: its own target judges it.
    second_look: SecondLook<N>,
    guard: Guard,
    last: Command,
    last_tick: Option<Instant>,
    /// Ticks in a row since one in which something was wrong that does not depend on memory.
    sound_ticks: u32,
}

/// A time of the configuration in whole milliseconds, as the view counts it.
fn milliseconds(seconds: f32) -> u64 {
    (seconds * 1000.0).round() as u64
}

/// Metres in millimetres, rounded up.
fn up(metres: f32) -> i32 {
    (metres * 1000.0).ceil() as i32
}

/// Advice as the guard is asked about it: in mm/s and mrad/s, towards zero; none if it is no number
/// or beyond 10 m/s or 20 rad/s.
fn in_whole_numbers(advice: Advice) -> Option<Twist> {
    let sensible = advice.speed.abs() <= 10.0 && advice.turn_rate.abs() <= 20.0;
    sensible.then_some(Twist {
        speed: (advice.speed * 1000.0) as i32,
        turn_rate: (advice.turn_rate * 1000.0) as i32,
    })
}

/// A hazard that is a little worse in every respect.
fn worse(hazard: &Hazard) -> Hazard {
    Hazard {
        clearance: hazard.clearance - 1,
        age: hazard.age + 1,
        way: hazard.way.map(|way| way + 1),
        turned: hazard.turned + 1,
        class: Class::Unknown,
        ..*hazard
    }
}

impl<L: Law<N> + Clone, const N: usize> Watched<L, N> {
    /// A controller at rest that is watched from now on; the goal in metres.
    ///
    /// # Panics
    /// If the goal is out of range.
    #[must_use]
    pub fn new(config: Config, ring: Ring<N>, law: L, goal: [f32; 2]) -> Self {
        let controller = Controller::new(config, ring, law, goal.into()).expect("a goal in range");
        Self {
            controller,
            config,
            ring,
            second_look: SecondLook::default(),
            guard: Guard::new(&config),
            last: Command::REST,
            last_tick: None,
            sound_ticks: 0,
        }
    }

    /// The last command.
    #[must_use]
    pub const fn last(&self) -> Command {
        self.last
    }

    /// Whether every reading of an observation can be one, as far as that shows without knowing
    /// what came before. Where this says no, the robot must be at rest.
    fn can_be_trusted(&self, observation: &Observation<N>) -> bool {
        let fresh = |taken_at: Instant, age_max: f32| {
            let age = observation.now.since(taken_at);
            age.is_some_and(|age| age <= milliseconds(age_max))
        };
        let ranges = observation.sonar.iter().all(|sample| {
            sample.is_some_and(|sample| {
                fresh(sample.taken_at, self.config.sonar_age_max)
                    && sample.range.is_finite()
                    && sample.range > 0.0
                    && sample.range >= self.config.sonar_range_min
            })
        });
        let pose = observation.odometry.is_some_and(|odometry| {
            fresh(odometry.taken_at, self.config.odometry_age_max)
                && odometry.x.is_finite()
                && odometry.y.is_finite()
                && odometry.heading.is_finite()
                && odometry.speed.is_finite()
                && odometry.turn_rate.is_finite()
        });
        let base = &observation.base;
        let in_order = base.motors_enabled && !base.stalled && !base.emergency_stop;
        let forward = self.last_tick.is_none_or(|last| observation.now >= last);
        ranges && pose && in_order && forward
    }

    /// One tick; what the law advised in it, if it was asked.
    ///
    /// # Panics
    /// If a predicate is broken.
    pub fn tick(&mut self, observation: &Observation<N>) -> (Decision<N>, Option<Advice>) {
        let counts = self.second_look.judged(observation, &self.config);
        let trusted = self.can_be_trusted(&counts);
        let elapsed = self
            .last_tick
            .and_then(|last| observation.now.since(last))
            .unwrap_or(0);
        let was_latched = self.controller.shield().is_latched();
        let mut law = self.controller.law().clone();
        let decision = self.controller.tick(observation);
        let advice = decision.view.as_ref().map(|view| law.advise(view));
        let advised = advice.map(in_whole_numbers);

        if trusted && advised != Some(None) {
            self.sound_ticks = self.sound_ticks.saturating_add(1);
        } else {
            self.sound_ticks = 0;
            assert!(decision.stop.is_some(), "no stop for {observation:?}");
            assert!(shield::untrusted_rests(
                decision.command.speed(),
                decision.command.turn_rate()
            ));
        }
        self.judge(&decision, elapsed, was_latched);
        if let Some(advised) = advised {
            self.judge_advice(&decision, advised.unwrap_or(Twist::REST));
        }
        if let Some(view) = &decision.view {
            // The law is told of every stop but the one that its own advice causes.
            let told = view.guard == decision.stop;
            assert!(told || decision.stop == Some(StopReason::AdviceInvalid));
            self.judge_view(view, &counts);
            self.judge_motion(view, decision.command);
        }
        self.last = decision.command;
        self.last_tick = Some(observation.now);
        (decision, advice)
    }

    /// A stop from outside, as when the link is lost.
    ///
    /// # Panics
    /// If a predicate is broken.
    pub fn halt(&mut self, reason: StopReason, now: Instant) {
        let was_latched = self.controller.shield().is_latched();
        let decision = self.controller.halt(reason, now);
        self.sound_ticks = 0;
        assert!(was_latched || decision.stop == Some(reason));
        assert!(shield::untrusted_rests(
            decision.command.speed(),
            decision.command.turn_rate()
        ));
        self.judge(&decision, 0, was_latched);
        self.last = decision.command;
        // A time that goes back is noticed by the next tick, and until then it is not the time.
        self.last_tick = Some(self.last_tick.map_or(now, |last| last.max(now)));
    }

    /// Somebody resets a latched stop.
    ///
    /// # Panics
    /// If it is still latched.
    pub fn reset(&mut self) {
        if self.controller.shield().is_latched() {
            self.sound_ticks = 0;
        }
        self.controller.reset();
        assert!(!self.controller.shield().is_latched());
    }

    fn limits(&self) -> &Limits {
        self.guard.limits()
    }

    /// What holds for every command, whatever was seen.
    fn judge(&self, decision: &Decision<N>, elapsed: u64, was_latched: bool) {
        let limits = self.limits();
        let (speed, turn_rate) = (decision.command.speed(), decision.command.turn_rate());
        assert!(shield::within_limits(
            speed,
            turn_rate,
            limits.speed_max(),
            limits.reverse_speed_max(),
            limits.turn_rate_max()
        ));
        assert!(shield::sees_where_it_goes(speed, self.ring.looks_back()));
        let latched = self.controller.shield().is_latched();
        let stopped = decision.stop.is_some();
        assert!(failsafe::latched_rests(
            was_latched,
            latched,
            speed,
            turn_rate
        ));
        assert!(stopped || !latched);
        assert!(shield::stop_is_kept(
            stopped,
            decision.stop.is_some_and(StopReason::may_turn),
            latched,
            speed,
            turn_rate
        ));
        // After a fault clears, motion waits for its number of ticks.
        assert!(stopped || self.sound_ticks >= self.config.resume_samples as u32);
        // What is done is as severe as what it is done about.
        let due = match (stopped, latched) {
            (_, true) => Action::LatchedStop,
            (true, false) => Action::Stop,
            (false, false) => Action::Run,
        };
        assert!(failsafe::monotone(decision.action, due));
        assert!((decision.action >= Action::Stop) == stopped);
        // However long the pause, the base gains no more than in one reaction time.
        let elapsed = elapsed.min(limits.reaction_time() as u64) as i32;
        assert!(shield::slew_kept(
            self.last.speed(),
            speed,
            limits.acceleration(),
            elapsed
        ));
        assert!(shield::slew_kept(
            self.last.turn_rate(),
            turn_rate,
            limits.turn_acceleration(),
            elapsed
        ));
        assert!(!decision.mode.is_empty());
        if let Some(reason) = decision.stop {
            assert!(!reason.to_string().is_empty());
        }
        if let Some(limit) = decision.limit {
            assert!(!limit.to_string().is_empty());
        }
    }

    /// A robot bends its path no tighter than its law would have it, and is not slower without a
    /// reason.
    fn judge_advice(&self, decision: &Decision<N>, advised: Twist) {
        let (speed, turn_rate) = (decision.command.speed(), decision.command.turn_rate());
        assert!(shield::no_tighter(
            speed,
            turn_rate,
            advised.speed,
            advised.turn_rate
        ));
        let slower = speed.abs() < advised.speed.abs();
        let reasoned = decision.stop.is_some() || decision.limit.is_some();
        assert!(
            !slower || reasoned,
            "advised {advised:?}, told {:?}, without a reason",
            decision.command
        );
    }

    /// What the robot may be at: as measured, and gained since, or as told.
    fn motion(&self, view: &View<N>) -> Motion {
        let limits = self.limits();
        let turn_rate = up(view.turn_rate.abs()).max(self.last.turn_rate().abs());
        let age = view.odometry_age.min(limits.reaction_time() as u64) as i32;
        let gained = (limits.acceleration() * age + 999) / 1000;
        let measured = up(view.speed.abs()) + limits.speed_error() + gained;
        let at_rest = view.speed == 0.0 && self.last.speed() == 0;
        Motion {
            speed: if at_rest {
                0
            } else {
                measured.max(self.last.speed().abs())
            },
            backward: view.speed < 0.0 || (view.speed == 0.0 && self.last.speed() < 0),
            turn_rate,
        }
    }

    /// What holds for a command that follows from a view.
    fn judge_motion(&self, view: &View<N>, command: Command) {
        let limits = self.limits();
        let twist = Twist {
            speed: command.speed(),
            turn_rate: command.turn_rate(),
        };
        let motion = self.motion(view);
        for (hazard, sonar) in view.hazard.iter().zip(self.ring.sonars()) {
            let closing = &sonar.closing;
            let room = has_room(limits, hazard, closing, &motion, twist);
            assert!(shield::admitted(twist.speed, twist.turn_rate, room));
            if twist != Twist::REST {
                let (bound, left) = left_for_turn(limits, hazard, closing, &motion, twist);
                assert!(shield::turn_ends_before_contact(
                    twist.turn_rate,
                    limits.turn_acceleration(),
                    limits.reaction_time(),
                    bound,
                    left,
                ));
            }
            let worse = worse(hazard);
            if let Some(plan) = self.guard.plan(twist.speed, twist.turn_rate, &motion) {
                assert!(shield::worse_is_no_easier(
                    limits.fits(hazard, closing, &plan),
                    limits.fits(&worse, closing, &plan)
                ));
            }
        }
        if let Some(obstacle) = &view.obstacle {
            // What is out of sight is no reason to go faster: no time that passes gives leave to
            // gain speed.
            let gaining = i32::from(obstacle.seen_now) * limits.reaction_time();
            assert!(shield::slew_kept(
                self.last.speed(),
                twist.speed,
                limits.acceleration(),
                gaining
            ));
            let distance = (obstacle.distance.get() * 1000.0) as i32 - obstacle.contact_range;
            let closing = twist.speed + up(obstacle.speed.value.get());
            assert!(shield::sound(
                distance.max(0),
                closing,
                limits.stop_time(),
                twist.speed <= 0
            ));
            // Beyond the promise, nothing is promised.
            assert!(!obstacle.speed.saturated || twist.speed <= 0);
        }
    }

    /// What holds for everything that is believed.
    fn judge_view(&self, view: &View<N>, observation: &Observation<N>) {
        let obstacle = view.obstacle.as_ref();
        assert!(belief::judged(
            view.speed,
            view.goal.distance,
            obstacle.map(|obstacle| obstacle.distance.get())
        ));
        let finite = |vector: &nalgebra::Vector2<f32>| vector.iter().all(|x| x.is_finite());
        assert!(finite(&view.pose.position) && avoid::angle_in_range(view.pose.heading.get()));
        assert!(avoid::angle_in_range(view.goal.heading.get()));
        if let Some(obstacle) = obstacle {
            assert!(finite(&obstacle.position));
            assert!(avoid::angle_in_range(obstacle.direction.get()));
            assert!(avoid::obstacle_speed_in_range(
                obstacle.speed.value.get(),
                self.config.obstacle_speed_max
            ));
        }
        for (i, reading) in view.sonar.iter().enumerate() {
            let usable = matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_));
            let sample = observation.sonar[i];
            let in_time = sample.is_some_and(|sample| {
                let age = observation.now.since(sample.taken_at);
                age.is_some_and(|age| age <= milliseconds(self.config.sonar_age_max))
            });
            let range = sample.map_or(f32::NAN, |sample| sample.range);
            assert!(belief::unusable_is_refused(range, in_time, usable));
            if let SonarReading::Echo(measured) = reading {
                let measured = (measured.get() * 1000.0) as i32;
                assert!(belief::nearer_counts(view.hazard[i].range, measured));
            }
            let loss = self.ring.sonars()[i].contact_range + up(self.config.range_error);
            assert_eq!(view.hazard[i].clearance, view.hazard[i].range - loss);
        }
    }
}
