//! S2: the Bayesian decision of Budiharto, Purwanto and Jazidie.
//!
//! A recursive Bayes filter over a few states ([`Belief`], [`TransitionMatrix`]), the posterior
//! expected loss of each action ([`LossTable`], [`DistanceLoss`]), and [`Decide`], which puts them
//! round a law: it hides from the law what is probably a false echo, and turns the law's motion into
//! a stop where stopping costs less. See `spec/decide.md`.
//!
//! Beliefs and losses are whole numbers: a belief is a number of parts of [`ONE`] for each state, and
//! the parts of all states are [`ONE`] exactly; a loss is in milliseconds. Decisions are therefore
//! exact, ties included. Nothing here is relied on for safety, which is the [`crate::shield`]'s: it
//! judges what the sonars said, not what is believed of it.

use crate::config::Config;
use crate::law::{Advice, Law};
use crate::math;
use crate::observation::SonarReading;
use crate::quantity::{Angle, Instant, Length, OutOfRange, Speed, in_range};
use crate::ring::{Ring, Sonar};
use crate::track::{self, Obstacle, Track};
use crate::view::{Class, Pose, View};
use core::fmt;
use nalgebra::Vector2;

mod belief;
mod loss;
mod second_look;
mod sensor;

pub use belief::{Belief, NoBelief, NotStochastic, ONE, TransitionMatrix};
pub use loss::{BadLoss, DistanceLoss, Dominated, LossTable, safest_of_the_least};
pub use second_look::SecondLook;
pub use sensor::{CameraLook, CameraModel, Hearing, SonarModel};

/// S2 E7 with E6: seconds until robot and obstacle are level along the axis of travel, for an
/// obstacle that is seen at `bearing` β. `None` if they never are.
///
/// $$t = \frac{d |\sin(\theta_R + \beta)|}{v_R |\sin \theta_R| + v_o |\sin \theta_o|}$$
///
/// For people to read. No bound: see [`crate::avoid::contact_time_bound`].
#[must_use]
pub fn time_to_level(
    distance: Length,
    heading: Angle,
    bearing: Angle,
    speed: Speed,
    obstacle_speed: Speed,
    direction: Angle,
) -> Option<f32> {
    let across = distance.get() * math::sin(heading.plus(bearing).get()).abs();
    let closing = speed.get() * math::sin(heading.get()).abs()
        + obstacle_speed.get() * math::sin(direction.get()).abs();
    let time = across / closing;
    (closing > 0.0 && time.is_finite()).then_some(time)
}

/// The states of S2 E18, as indices of beliefs, likelihoods and losses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// θ1: there is an obstacle.
    Obstacle,
    /// θ2: there is none.
    Nothing,
}

/// What a robot can do about it, from the boldest to the safest. S2 E20 has the last two; going on is
/// what its algorithm does where it predicts no collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Response {
    /// Go on as if there were nothing.
    Continue,
    /// a1: go round it.
    Maneuver,
    /// a2: drive no further.
    Stop,
}

impl Response {
    /// The actions of a table with three rows.
    const ALL: [Self; 3] = [Self::Continue, Self::Maneuver, Self::Stop];
}

/// What the decision rests on; plain numbers that [`Settings::new`] checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The sonars; shares of 0.001 to 0.5, a range of 0.8 to 20 m.
    pub sonar: SonarModel,
    /// The camera; shares of 0.001 to 0.999.
    pub camera: CameraModel,
    /// Probability that an echo from where nothing was expected is of a thing, 0.001 to 0.999.
    pub newcomer: f32,
    /// Probability per sonar period that a thing comes to a place where there was none, 0 to 0.5.
    pub appear: f32,
    /// Probability per sonar period that a thing leaves its place, 0 to 0.5.
    pub vanish: f32,
    /// Least probability of a state, ε, 10⁻⁶ to 0.1.
    pub floor: f32,
    /// Time between two looks of a sonar, 10 to 1000 ms: 100 ms in S2. A reading that stands counts
    /// again after it, not before.
    pub sonar_period: u64,
    /// Time between two pictures, 10 to 5000 ms: 500 ms in S2. Older looks are too late to count.
    pub vision_period: u64,
    /// Time between two commands, 10 to 1000 ms: 220 ms in S2. Without any evidence for longer the
    /// decision is to stop.
    pub control_period: u64,
    /// Losses far away, seconds: [`Response`] by [`State`].
    pub far_loss: [[f32; 2]; 3],
    /// Losses at the minimum distance.
    pub near_loss: [[f32; 2]; 3],
}

impl Parameters {
    /// Rates of sensors and losses that `spec/decide.md` gives reasons for.
    pub const USUAL: Self = Self {
        sonar: SonarModel {
            miss: 0.1,
            false_echo: 0.1,
            false_range: 2.5,
        },
        camera: CameraModel {
            detection: 0.93,
            false_alarm: 0.05,
        },
        newcomer: 0.1,
        appear: 0.001,
        vanish: 0.02,
        floor: 1e-3,
        sonar_period: 100,
        vision_period: 500,
        control_period: 220,
        far_loss: [[5.0, 0.0], [0.0, 5.0], [5.0, 10.0]],
        near_loss: [[40.0, 0.0], [6.0, 5.0], [5.0, 10.0]],
    };
}

/// Parameters that were checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    parameters: Parameters,
    transition: TransitionMatrix<2>,
    loss: DistanceLoss<3, 2>,
    /// What is believed of an echo from where nothing was expected.
    first: Belief<2>,
    /// The floor ε in parts of [`ONE`].
    least: u32,
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BadSettings {
    /// A parameter.
    OutOfRange(OutOfRange),
    /// The losses.
    Loss(BadLoss),
}

impl fmt::Display for BadSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Loss(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BadSettings {}

impl From<OutOfRange> for BadSettings {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<BadLoss> for BadSettings {
    fn from(error: BadLoss) -> Self {
        Self::Loss(error)
    }
}

impl Settings {
    /// Checks parameters; the far losses hold at the configuration's `safe_distance`, the near ones at
    /// its `min_distance`.
    ///
    /// # Errors
    /// [`BadSettings`] naming what is out of range, or an action that is dominated at every distance.
    pub fn new(parameters: Parameters, config: &Config) -> Result<Self, BadSettings> {
        let p = &parameters;
        in_range("sonar.miss", p.sonar.miss, 1e-3, 0.5, "share")?;
        in_range("sonar.false_echo", p.sonar.false_echo, 1e-3, 0.5, "share")?;
        let false_range = p.sonar.false_range;
        in_range("sonar.false_range", false_range, 0.8, 20.0, "m")?;
        in_range("camera.detection", p.camera.detection, 1e-3, 0.999, "share")?;
        let false_alarm = p.camera.false_alarm;
        in_range("camera.false_alarm", false_alarm, 1e-3, 0.999, "share")?;
        let newcomer = in_range("newcomer", p.newcomer, 1e-3, 0.999, "share")?;
        let appear = in_range("appear", p.appear, 0.0, 0.5, "share")?;
        let vanish = in_range("vanish", p.vanish, 0.0, 0.5, "share")?;
        let floor = in_range("floor", p.floor, 1e-6, 0.1, "share")?;
        in_range("sonar_period", p.sonar_period as f32, 10.0, 1e3, "ms")?;
        in_range("vision_period", p.vision_period as f32, 10.0, 5e3, "ms")?;
        in_range("control_period", p.control_period as f32, 10.0, 1e3, "ms")?;
        let far = LossTable::with_dominated(&p.far_loss)?;
        let near = LossTable::with_dominated(&p.near_loss)?;
        let at = |metres| Length::metres(metres).unwrap_or(Length::ZERO);
        let loss = DistanceLoss::new(far, at(config.safe_distance), near, at(config.min_distance))?;
        // Neither of these is refused, with the probabilities above.
        let even = Belief::even();
        let transition = TransitionMatrix::new(&[[1.0 - vanish, vanish], [appear, 1.0 - appear]])
            .unwrap_or(TransitionMatrix::even());
        let first = Belief::from_weights(&[newcomer, 1.0 - newcomer]).unwrap_or(even);
        Ok(Self {
            parameters,
            transition,
            loss,
            first,
            least: (floor * ONE as f32) as u32,
        })
    }

    /// The usual settings.
    ///
    /// # Errors
    /// [`BadSettings`] if the configuration's minimum distance is within 1 cm of its safe distance.
    pub fn usual(config: &Config) -> Result<Self, BadSettings> {
        Self::new(Parameters::USUAL, config)
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The losses by distance.
    #[must_use]
    pub const fn loss(&self) -> &DistanceLoss<3, 2> {
        &self.loss
    }

    /// S2 E13 with the floor: the belief after an observation, unless that is impossible.
    ///
    /// # Errors
    /// [`NoBelief`] if a likelihood is no weight, or none is above 0.
    pub fn observe(
        &self,
        belief: &Belief<2>,
        likelihood: &[f32; 2],
    ) -> Result<Belief<2>, NoBelief> {
        let belief = belief.updated(likelihood)?;
        Ok(belief.raised(self.least))
    }

    /// What is best done about a thing at a distance that is there with this probability.
    //= decide.INV-12
    #[must_use]
    pub fn respond(&self, belief: &Belief<2>, distance: Length) -> Response {
        let chosen = self.loss.at(distance).choose(belief);
        Response::ALL.get(chosen).copied().unwrap_or(Response::Stop)
    }
}

/// Places where something may be that are kept in mind at once.
const PLACES: usize = 16;

/// Echoes within this distance of a place, in metres, may come from there: [`crate::track`] has the
/// same.
const GATE: f32 = 0.4;

/// Echoes of one thing scatter by no more than this, in metres, beyond what moved meanwhile.
const SCATTER: f32 = 0.15;

/// A place believed in less than this is forgotten.
const FORGOTTEN: f32 = 0.02;

/// Somebody whom a camera detected is within this angle of where it says, in radians.
const CAMERA_ANGLE: f32 = 0.26;

/// After this many steps a belief without evidence is what it is without any.
const STEPS_MAX: u64 = 200;

/// Where something may be.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// In the odometry frame.
    position: Vector2<f32>,
    belief: Belief<2>,
    /// When an echo came from there last.
    heard: Instant,
}

impl Place {
    /// An echo from the thing in this place differs from its distance by no more than this, m: by what
    /// echoes scatter and by how far it may have moved.
    fn gate(&self, now: Instant, config: &Config) -> f32 {
        let age = now.since(self.heard).unwrap_or(0).min(1_000) as f32 / 1000.0;
        (SCATTER + config.obstacle_speed_max * age).min(GATE)
    }
}

/// A usable reading of a sonar.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sound {
    echo: bool,
    /// Of the echo, or up to which there was none, m.
    range: f32,
}

impl Sound {
    /// None if the reading is not usable.
    fn of(reading: SonarReading) -> Option<Self> {
        let (echo, range) = match reading {
            SonarReading::Echo(range) => (true, range.get()),
            SonarReading::TooNear => (true, 0.0),
            SonarReading::NoEcho(range) => (false, range.get()),
            SonarReading::Stale | SonarReading::Invalid => return None,
        };
        Some(Self { echo, range })
    }

    /// What it says of a place.
    fn of_place(
        &self,
        place: Vector2<f32>,
        gate: f32,
        sonar: &Sonar,
        pose: &Pose,
        config: &Config,
    ) -> Hearing {
        let offset = pose.to_robot(place) - sonar.position;
        let distance = math::norm(offset);
        let covered = offset.dot(&sonar.axis) >= distance * math::cos(config.sonar_half_angle);
        let level = (self.range - distance).abs() <= gate;
        let beside = math::norm(offset - sonar.axis * self.range) <= GATE;
        match (self.echo && level, covered) {
            (true, true) => Hearing::There,
            (true, false) if beside => Hearing::Beside,
            (false, true) if self.range > distance + gate => Hearing::Past,
            _ => Hearing::Nothing,
        }
    }
}

/// What was decided in a tick, for people to see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// What is done.
    pub response: Response,
    /// There was no evidence for too long: that, and no belief, is why it is to stop.
    pub blind: bool,
    /// Probability that the obstacle is there, if there is one.
    pub probability: Option<f32>,
    /// Its distance.
    pub distance: Option<Length>,
    /// Expected losses at that distance, in seconds, by [`Response`].
    pub expected: Option<[f32; 3]>,
    /// Probability of the most probable place with an echo that is *not* believed.
    pub doubted: Option<f32>,
    /// The law advised to drive ahead, and is made to stand.
    pub overruled: bool,
}

impl Verdict {
    /// Nothing to decide.
    const IDLE: Self = Self {
        response: Response::Continue,
        blind: false,
        probability: None,
        distance: None,
        expected: None,
        doubted: None,
        overruled: false,
    };
}

/// S2's decision round a law.
///
/// The law is shown the obstacle that is believed in, not the one that an echo suggests; everything
/// else of the view is shown as it is. Where the decision is to stop, the law's advice to drive ahead
/// becomes advice to stand; otherwise its advice is passed on as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decide<L, const N: usize> {
    law: L,
    config: Config,
    ring: Ring<N>,
    settings: Settings,
    places: [Option<Place>; PLACES],
    track: Option<Track>,
    /// What each sonar said last that counted, and when.
    heard: [Option<(SonarReading, Instant)>; N],
    /// A camera's look that has not counted yet.
    look: Option<CameraLook>,
    /// The last tick.
    last: Option<Instant>,
    /// When there was evidence last.
    evidence: Option<Instant>,
    verdict: Verdict,
}

impl<L, const N: usize> Decide<L, N> {
    /// Puts the decision round a law.
    #[must_use]
    pub const fn new(law: L, config: Config, ring: Ring<N>, settings: Settings) -> Self {
        Self {
            law,
            config,
            ring,
            settings,
            places: [None; PLACES],
            track: None,
            heard: [None; N],
            look: None,
            last: None,
            evidence: None,
            verdict: Verdict::IDLE,
        }
    }

    /// The law.
    #[must_use]
    pub const fn law(&self) -> &L {
        &self.law
    }

    /// The law, to tell it what no view holds.
    pub const fn law_mut(&mut self) -> &mut L {
        &mut self.law
    }

    /// What was decided last.
    #[must_use]
    pub const fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Takes in a camera's look; it counts in the next tick, once, unless it is too old by then.
    pub const fn see(&mut self, look: CameraLook) {
        self.look = Some(look);
    }

    /// Which readings are new: those that changed, and those that have stood for a sonar period.
    fn fresh(&mut self, view: &View<N>) -> [bool; N] {
        let mut fresh = [false; N];
        for (i, fresh) in fresh.iter_mut().enumerate() {
            let reading = view.sonar[i];
            let usable = !matches!(reading, SonarReading::Stale | SonarReading::Invalid);
            let stood = |since: Instant| {
                let period = self.settings.parameters.sonar_period;
                view.now.since(since).is_some_and(|time| time >= period)
            };
            let new = self.heard[i].is_none_or(|(before, at)| before != reading || stood(at));
            if usable && new {
                *fresh = true;
                self.heard[i] = Some((reading, view.now));
                self.evidence = Some(view.now);
            }
        }
        fresh
    }

    /// S2 E16, as many times as sonar periods have passed.
    fn predict(&mut self, now: Instant) {
        let elapsed = self.last.and_then(|last| now.since(last)).unwrap_or(0);
        // Half a period or more is one: ticks and looks need not keep step.
        let period = self.settings.parameters.sonar_period.max(1);
        let steps = (elapsed.min(STEPS_MAX * period) + period / 2) / period;
        for place in self.places.iter_mut().flatten() {
            for _ in 0..steps {
                place.belief = place.belief.predicted(&self.settings.transition);
            }
        }
        self.last = Some(now);
    }

    /// S2 E13: what the sonars say of the places, and places for echoes from where none was expected.
    fn update(&mut self, view: &View<N>, fresh: &[bool; N]) {
        let interest = self.config.safe_distance + GATE;
        for (i, &fresh) in fresh.iter().enumerate() {
            let Some(sound) = Sound::of(view.sonar[i]).filter(|_| fresh) else {
                continue;
            };
            let sonar = &self.ring.sonars()[i];
            let from = view
                .pose
                .to_world(sonar.position + sonar.axis * sound.range);
            // An echo is one thing's: that of the place it fits best.
            let source = self.source(&sound, sonar, view);
            for (k, slot) in self.places.iter_mut().enumerate() {
                let Some(place) = slot else { continue };
                let gate = place.gate(view.now, &self.config);
                let mut hearing =
                    sound.of_place(place.position, gate, sonar, &view.pose, &self.config);
                if hearing == Hearing::There && source != Some(k) {
                    hearing = Hearing::Nothing;
                }
                let likelihood = self.settings.parameters.sonar.likelihood(hearing, gate);
                // Likelihoods are positive, and so is each belief, by its floor: there is a posterior.
                if let Ok(belief) = self.settings.observe(&place.belief, &likelihood) {
                    place.belief = belief;
                }
                if hearing == Hearing::There {
                    place.position = from;
                    place.heard = view.now;
                }
            }
            if sound.echo && source.is_none() && sound.range <= interest {
                self.add(
                    Place {
                        position: from,
                        belief: self.settings.first,
                        heard: view.now,
                    },
                    view.pose.position,
                );
            }
        }
    }

    /// The place that an echo fits best, if it fits any: one that the sonar covers before one beside,
    /// then the one at the most similar distance.
    fn source(&self, sound: &Sound, sonar: &Sonar, view: &View<N>) -> Option<usize> {
        let mut best: Option<(usize, bool, f32)> = None;
        for (k, slot) in self.places.iter().enumerate() {
            let Some(place) = slot else { continue };
            let gate = place.gate(view.now, &self.config);
            let hearing = sound.of_place(place.position, gate, sonar, &view.pose, &self.config);
            let covered = match hearing {
                Hearing::There => true,
                Hearing::Beside => false,
                Hearing::Past | Hearing::Nothing => continue,
            };
            let offset = view.pose.to_robot(place.position) - sonar.position;
            let off = (math::norm(offset) - sound.range).abs();
            let better = best.is_none_or(|(_, before, least)| {
                (covered && !before) || (covered == before && off < least)
            });
            if better {
                best = Some((k, covered, off));
            }
        }
        best.map(|(k, ..)| k)
    }

    /// What a camera says of the places in its field of view.
    fn look(&mut self, view: &View<N>) {
        let Some(look) = self.look.take() else { return };
        let vision = self.settings.parameters.vision_period;
        if view.now.since(look.taken_at).is_none_or(|age| age > vision) {
            return;
        }
        self.evidence = Some(view.now);
        for place in self.places.iter_mut().flatten() {
            let offset = view.pose.to_robot(place.position);
            let bearing = Angle::radians(math::atan2(offset.y, offset.x)).unwrap_or(Angle::ZERO);
            let likelihood = match look.detected {
                Some(at) if bearing.minus(at).get().abs() <= CAMERA_ANGLE => {
                    self.settings.parameters.camera.likelihood(true)
                }
                None if bearing.get().abs() <= self.config.view_half_angle => {
                    self.settings.parameters.camera.likelihood(false)
                }
                // Somebody else was detected: nothing is said of this one.
                _ => continue,
            };
            if let Ok(belief) = self.settings.observe(&place.belief, &likelihood) {
                place.belief = belief;
            }
        }
    }

    /// Keeps a place in mind, instead of the farthest if there are too many.
    fn add(&mut self, place: Place, robot: Vector2<f32>) {
        let away = |place: &Place| math::norm(place.position - robot);
        let (mut farthest, mut most) = (None, away(&place));
        for i in 0..PLACES {
            let Some(held) = &self.places[i] else {
                self.places[i] = Some(place);
                return;
            };
            if away(held) > most {
                (farthest, most) = (Some(i), away(held));
            }
        }
        if let Some(slot) = farthest.and_then(|i| self.places.get_mut(i)) {
            *slot = Some(place);
        }
    }

    /// Forgets places that are not believed in, that are far away by now, or that have turned out to be
    /// another's.
    fn forget(&mut self, robot: Vector2<f32>) {
        for i in 0..PLACES {
            let Some(place) = self.places[i] else {
                continue;
            };
            let twin = self.places.iter().enumerate().any(|(k, other)| {
                other.is_some_and(|other| {
                    let near = math::norm(other.position - place.position) <= SCATTER;
                    let (one, two) = (place.belief.parts()[0], other.belief.parts()[0]);
                    k != i && near && (two > one || (two == one && k < i))
                })
            });
            let away = math::norm(place.position - robot);
            let far = away > self.config.safe_distance + self.config.robot_radius + 2.0 * GATE;
            if twin || far || place.belief.probability(0) < FORGOTTEN {
                self.places[i] = None;
            }
        }
    }

    /// The belief in the place nearest to a point, if one is within the gate.
    fn belief_at(&self, point: Vector2<f32>) -> Option<Belief<2>> {
        let mut found = None;
        let mut nearest = GATE;
        for place in self.places.iter().flatten() {
            let offset = math::norm(place.position - point);
            if offset <= nearest {
                (found, nearest) = (Some(place.belief), offset);
            }
        }
        found
    }

    /// The readings with only those echoes that are believed, and the greatest doubted probability.
    fn believed(&self, view: &View<N>) -> ([SonarReading; N], Option<f32>) {
        let silence = Length::metres(self.config.sonar_range_max).unwrap_or(Length::MAX);
        let mut readings = view.sonar;
        let mut doubted: Option<f32> = None;
        for (reading, at) in readings.iter_mut().zip(self.ring.sonars()) {
            let SonarReading::Echo(range) = *reading else {
                continue;
            };
            let sound = Sound {
                echo: true,
                range: range.get(),
            };
            // What is not kept in mind, being far away or one too many, is taken as it is.
            let source = self.source(&sound, at, view);
            let Some(Place { belief, .. }) =
                source.and_then(|k| self.places.get(k).copied().flatten())
            else {
                continue;
            };
            if self.settings.respond(&belief, range) == Response::Continue {
                *reading = SonarReading::NoEcho(silence);
                let probability = belief.probability(0);
                doubted = Some(doubted.map_or(probability, |most| most.max(probability)));
            }
        }
        (readings, doubted)
    }

    /// The robot, driving as it looks, runs into the obstacle: it is ahead and within the corridor.
    fn collides(&self, obstacle: &Obstacle, pose: &Pose) -> bool {
        let offset = pose.to_robot(obstacle.position);
        offset.x > 0.0 && offset.y.abs() <= self.config.robot_radius + self.config.corridor_margin
    }

    /// S2 E22 and A1: what to do about the obstacle that is believed in.
    //= decide.INV-15
    fn decide(&self, view: &View<N>, obstacle: Option<&Obstacle>, doubted: Option<f32>) -> Verdict {
        let late = |evidence| {
            let period = self.settings.parameters.control_period;
            view.now.since(evidence).is_none_or(|time| time > period)
        };
        let mut verdict = Verdict {
            doubted,
            ..Verdict::IDLE
        };
        if let Some(obstacle) = obstacle {
            verdict.distance = Some(obstacle.distance);
            // What is far away is not judged, and concerns nobody yet.
            if let Some(belief) = self.belief_at(obstacle.position) {
                let table = self.settings.loss.at(obstacle.distance);
                verdict.probability = Some(belief.probability(0));
                verdict.expected = Some(table.expected_seconds(&belief));
                let inside = obstacle.distance.get() < self.config.safe_distance;
                verdict.response = match self.settings.respond(&belief, obstacle.distance) {
                    Response::Stop if self.collides(obstacle, &view.pose) => Response::Stop,
                    // What is followed was believed in: losing sight of it is no reason to go on.
                    _ if inside => Response::Maneuver,
                    _ => Response::Continue,
                };
            }
        }
        if self.evidence.is_none_or(late) {
            verdict.response = Response::Stop;
            verdict.blind = true;
        }
        verdict
    }
}

/// What becomes of a law's advice, and whether it was overruled: a stop makes motion ahead into none,
/// and leaves turning and backing off as they are; anything else leaves the advice as it is. Advice
/// that is no number is passed on: the shield has a name for it.
//= decide.INV-13
#[must_use]
pub fn overruled(advice: Advice, response: Response) -> (Advice, bool) {
    if response == Response::Stop && advice.speed > 0.0 {
        let stands = Advice {
            speed: 0.0,
            ..advice
        };
        return (stands, true);
    }
    (advice, false)
}

impl<L: Law<N>, const N: usize> Law<N> for Decide<L, N> {
    //= decide.INV-14
    fn advise(&mut self, view: &View<N>) -> Advice {
        let fresh = self.fresh(view);
        self.predict(view.now);
        self.update(view, &fresh);
        self.look(view);
        let (readings, doubted) = self.believed(view);
        let (pose, now) = (&view.pose, view.now);
        track::follow(
            &mut self.track,
            &readings,
            &fresh,
            pose,
            now,
            &self.ring,
            &self.config,
        );
        let obstacle = self.track.map(|track| {
            let look = track::Look {
                now,
                pose,
                speed: view.speed,
                sighting: None,
                still: view
                    .hazard
                    .get(track.sonar())
                    .is_some_and(|hazard| hazard.class == Class::Still),
            };
            track.obstacle(&look, &self.config)
        });
        self.verdict = self.decide(view, obstacle.as_ref(), doubted);
        self.forget(pose.position);
        let advice = self.law.advise(&View { obstacle, ..*view });
        let (advice, overruled) = overruled(advice, self.verdict.response);
        self.verdict.overruled = overruled;
        advice
    }

    fn mode(&self) -> &'static str {
        match (self.verdict.overruled, self.verdict.blind) {
            (true, true) => "no evidence",
            (true, false) => "decided to stop",
            (false, _) => self.law.mode(),
        }
    }
}
