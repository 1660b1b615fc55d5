//! Searches of one number within a bracket: roots, borders of conditions, and extreme values.
//!
//! All numbers have the unit of the caller. Each search ends after a number of steps or at a width that the caller states, and each
//! step evaluates a condition or a function at the places that its doc names, so that a result repeats to the last bit.

/// Two places between which a condition changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket {
    /// A place at which the condition holds; it may lie on either side of the other one.
    pub holds: f64,
    /// A place at which it does not hold.
    pub fails: f64,
}

impl Bracket {
    /// The place half way between both.
    pub fn middle(&self) -> f64 {
        0.5 * (self.holds + self.fails)
    }

    /// The bracket after a number of bisections: each asks for the condition in the middle and keeps the half in which it changes. The
    /// condition is not evaluated at the ends of the first bracket.
    #[must_use]
    pub fn halved(mut self, times: usize, mut condition: impl FnMut(f64) -> bool) -> Self {
        for _ in 0..times {
            self.halve(&mut condition);
        }
        self
    }

    /// As [`Self::halved`], for a condition that changes once within the bracket, from a guess of the place at which it does: the
    /// nearer the guess, the fewer questions. A condition that changes more than once may give another of its changes.
    #[must_use]
    pub fn halved_near(self, times: usize, guess: f64, mut condition: impl FnMut(f64) -> bool) -> Self {
        let count = 1_usize << times;
        // The bracket that bisection ends with where the condition changes in a part, counted from where it holds.
        let part = |number: usize| {
            (0..times).rev().fold(self, |bracket, bit| match number >> bit & 1 {
                0 => Self { fails: bracket.middle(), ..bracket },
                _ => Self { holds: bracket.middle(), ..bracket },
            })
        };
        let mut holds_at = |number: usize| condition(part(number).holds);
        let (mut holds, mut fails) = (0, count);
        // A cast saturates at zero; a guess that is no number is the first part.
        let share = (guess - self.holds) / (self.fails - self.holds);
        let near = ((share * count as f64) as usize).min(count - 1);
        let mut step = 1;
        if near == 0 || holds_at(near) {
            holds = near;
            while holds + step < fails {
                if holds_at(holds + step) {
                    holds += step
                } else {
                    fails = holds + step
                }
                step *= 2;
            }
        } else {
            fails = near;
            while holds + step < fails {
                if holds_at(fails - step) {
                    holds = fails - step
                } else {
                    fails -= step
                }
                step *= 2;
            }
        }
        part(last_whole(holds, fails, holds_at))
    }

    /// The bracket after bisections down to a width, or to neighbouring numbers where these are farther apart.
    #[must_use]
    pub fn narrowed(mut self, width: f64, mut condition: impl FnMut(f64) -> bool) -> Self {
        while (self.fails - self.holds).abs() > width && ![self.holds, self.fails].contains(&self.middle()) {
            self.halve(&mut condition);
        }
        self
    }

    fn halve(&mut self, condition: &mut impl FnMut(f64) -> bool) {
        let middle = self.middle();
        if condition(middle) { self.holds = middle } else { self.fails = middle }
    }
}

/// The last whole number on the way from `holds` to `fails` at which a condition holds, by bisection, for a condition that changes once.
/// It counts as holding at `holds` and as failing at `fails`, and is not evaluated there.
pub fn last_whole(mut holds: usize, mut fails: usize, mut condition: impl FnMut(usize) -> bool) -> usize {
    while holds.abs_diff(fails) > 1 {
        let middle = holds.midpoint(fails);
        if condition(middle) { holds = middle } else { fails = middle }
    }
    holds
}

/// The interval after a number of steps, each of which takes away a third: that behind `high - third` where the function at
/// `low + third` is not greater than there, else that before `low + third`. It keeps the place of the only minimum.
pub fn around_minimum([mut low, mut high]: [f64; 2], steps: usize, mut f: impl FnMut(f64) -> f64) -> [f64; 2] {
    for _ in 0..steps {
        let third = (high - low) / 3.0;
        let [before, behind] = [low + third, high - third];
        if f(before) <= f(behind) { high = behind } else { low = before }
    }
    [low, high]
}

/// Share of an interval that a golden section takes away.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

/// Largest number of steps of [`greatest`]; parabolas need some eight.
const MAX_PARABOLAS: usize = 60;

/// Greatest value of a function with one maximum within an interval, at a place that is known to `width`, by parabolas through the
/// three best places and by golden sections where a parabola does not lead on (Brent 1973, chapter 5). The ends are not evaluated.
pub fn greatest(mut f: impl FnMut(f64) -> f64, [mut low, mut high]: [f64; 2], width: f64) -> f64 {
    let place = low + GOLDEN * (high - low);
    // The best place, the second and the third, with their values.
    let [mut best, mut second, mut third] = [(place, f(place)); 3];
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..MAX_PARABOLAS {
        let middle = 0.5 * (low + high);
        if (best.0 - middle).abs() + 0.5 * (high - low) <= 2.0 * width {
            break;
        }
        let (to_second, to_third) = (best.0 - second.0, best.0 - third.0);
        let (r, q) = (to_second * (best.1 - third.1), to_third * (best.1 - second.1));
        let (over, under) = (to_third * q - to_second * r, 2.0 * (r - q));
        let parabola = over / under;
        let next = best.0 + parabola;
        // Of places with equal or infinite values there is no parabola.
        if before.abs() > width && parabola.abs() < 0.5 * before.abs() && low < next && next < high {
            (before, step) = (step, parabola);
            if next - low < 2.0 * width || high - next < 2.0 * width {
                step = width.copysign(middle - best.0);
            }
        } else {
            before = if best.0 < middle { high - best.0 } else { low - best.0 };
            step = GOLDEN * before;
        }
        let place = best.0 + if step.abs() < width { width.copysign(step) } else { step };
        let tried = (place, f(place));
        if tried.1 >= best.1 {
            if tried.0 >= best.0 {
                low = best.0
            } else {
                high = best.0
            }
            (third, second, best) = (second, best, tried);
            continue;
        }
        if tried.0 < best.0 {
            low = tried.0
        } else {
            high = tried.0
        }
        if tried.1 >= second.1 || second.0 == best.0 {
            (third, second) = (second, tried);
        } else if tried.1 >= third.1 || third.0 == best.0 || third.0 == second.0 {
            third = tried;
        }
    }
    best.1
}

/// Largest number of steps of [`root`]; Newton's method needs some six.
const MAX_ROOT_STEPS: usize = 60;

/// Length of a step of [`root`] that is rounding.
const STEP_ROUNDING: f64 = 1e-15;

/// Root of a function that rises from the first end of a bracket to the second, by Newton's method from `start`: bisection where a step
/// would leave the bracket, or where the function does not rise. `at` gives value and derivative. Ends with a step shorter than 1e-15,
/// which is rounding of parameters in [0, 1], or after 60 steps.
pub fn root([mut low, mut high]: [f64; 2], start: f64, mut at: impl FnMut(f64) -> [f64; 2]) -> f64 {
    let mut x = start;
    for _ in 0..MAX_ROOT_STEPS {
        let [value, slope] = at(x);
        if value == 0.0 {
            break;
        }
        if value > 0.0 {
            high = x
        } else {
            low = x
        }
        let newton = x - value / slope;
        let next = if slope > 0.0 && low <= newton && newton <= high { newton } else { 0.5 * (low + high) };
        let change = (next - x).abs();
        x = next;
        if change < STEP_ROUNDING {
            break;
        }
    }
    x
}

/// A bracket of a root that secants narrow, with half the weight for an end that does not move: else it would never (Illinois). The
/// function is negative at the low end only.
#[derive(Clone, Copy, Debug)]
pub struct SecantBracket {
    /// Low and high end.
    pub ends: [f64; 2],
    weights: [f64; 2],
    /// The end that moved last.
    moved: Option<usize>,
}

impl SecantBracket {
    /// Both ends with the values of the function there.
    pub fn new(ends: [f64; 2], values: [f64; 2]) -> Self {
        Self { ends, weights: values, moved: None }
    }

    /// Width.
    pub fn width(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// Where the secant is zero; through rounding this may be an end or lie beyond it.
    pub fn next(&self) -> f64 {
        let [low, high] = self.weights;
        self.ends[1] - high * self.width() / (high - low)
    }

    /// Takes a place within the bracket, with the value of the function there, as its new end.
    pub fn take(&mut self, x: f64, value: f64) {
        let end = usize::from(value.is_nan() || value >= 0.0);
        (self.ends[end], self.weights[end]) = (x, value);
        if self.moved == Some(end) {
            self.weights[1 - end] *= 0.5;
        }
        self.moved = Some(end);
    }
}

/// When secants end: after a number of steps, at a value of the function, or where it does not change.
#[derive(Clone, Copy, Debug)]
pub struct SecantEnd {
    /// Most steps.
    pub steps: usize,
    /// Absolute value of the function below which its argument is the root.
    pub exact: f64,
    /// Difference of two values below which there is no slope.
    pub level: f64,
}

/// Root of a function that is nearly straight, by secants through two places. No step goes farther than `reach` from the first of them:
/// a function without a root ends there.
pub fn secant([mut a, mut b]: [f64; 2], reach: f64, end: SecantEnd, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (low, high) = (a - reach, a + reach);
    let (mut f_a, mut f_b) = (f(a), f(b));
    for _ in 0..end.steps {
        if (f_b - f_a).abs() < end.level || f_b.abs() < end.exact {
            break;
        }
        let next = (b - f_b * (b - a) / (f_b - f_a)).clamp(low, high);
        (a, f_a) = (b, f_b);
        (b, f_b) = (next, f(next));
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn bisection_finds_a_border_from_both_sides() {
        for border in [0.1, 0.5, 1.0 / 3.0, 0.999] {
            let rising = Bracket { holds: 1.0, fails: 0.0 }.halved(40, |x| x >= border);
            let falling = Bracket { holds: 0.0, fails: 1.0 }.halved(40, |x| x < border);
            assert!(rising.holds >= border && rising.fails < border && rising.holds - rising.fails < 1e-11);
            assert_eq!((rising.holds, rising.fails), (falling.fails, falling.holds));
            assert_eq!(rising.middle().to_bits(), falling.middle().to_bits());
        }
    }

    /// The same bracket as by bisection, to the last bit, with few questions for a good guess.
    #[test]
    fn a_guess_changes_only_the_number_of_questions() {
        for border in [0.0, 1e-4, 0.3, 0.7, 1.0 - 1e-4, 1.0] {
            for bracket in [Bracket { holds: -0.3, fails: 1.7 }, Bracket { holds: 1.7, fails: -0.3 }] {
                let condition = |x: f64| (x < border) == (bracket.holds < border);
                let halved = bracket.halved(10, condition);
                for guess in [-9.0, -0.3, 0.1, border - 0.01, border, border + 0.004, 1.7, 9.0, f64::NAN] {
                    let mut count = 0;
                    let near = bracket.halved_near(10, guess, |x| {
                        count += 1;
                        condition(x)
                    });
                    assert_eq!(near, halved, "{border} {guess}");
                    assert!(count <= if guess == border { 3 } else { 20 }, "{border} {guess}: {count}");
                }
            }
        }
    }

    /// As many questions as halvings, and none at the ends.
    #[test]
    fn bisection_asks_in_the_middle_only() {
        let tried = Cell::new(Vec::new());
        let ask = |x: f64| {
            let mut all = tried.take();
            all.push(x);
            tried.set(all);
            x < 0.3
        };
        let found = Bracket { holds: 0.0, fails: 1.0 }.halved(3, ask);
        assert_eq!(tried.take(), [0.5, 0.25, 0.375]);
        assert_eq!(found, Bracket { holds: 0.25, fails: 0.375 });
        let found = Bracket { holds: 0.0, fails: 1.0 }.narrowed(0.125, ask);
        assert_eq!((tried.take().len(), found), (3, Bracket { holds: 0.25, fails: 0.375 }));
    }

    #[test]
    fn bisection_to_a_width_below_rounding_ends() {
        let found = Bracket { holds: 1.0, fails: 2.0 }.narrowed(0.0, |x| x * x <= 2.0);
        assert_eq!(found.fails.to_bits() - found.holds.to_bits(), 1);
        assert!(found.holds * found.holds <= 2.0 && found.fails * found.fails > 2.0);
    }

    #[test]
    fn whole_numbers_are_the_last_ones() {
        for last in 0..9 {
            assert_eq!(last_whole(0, 9, |k| k <= last), last);
            assert_eq!(last_whole(9, 0, |k| k > last), last + 1);
        }
        assert_eq!(last_whole(4, 4, |_| unreachable!()), 4);
    }

    #[test]
    fn extreme_values_are_found() {
        for place in [0.02, 0.31, 0.77] {
            let f = |x: f64| (x - place) * (x - place) * (1.0 + x);
            let [low, high] = around_minimum([0.0, 1.0], 40, f);
            assert!(low <= place + 1e-7 && high >= place - 1e-7 && high - low < 1e-6);
            assert!((greatest(|x| 3.0 - f(x), [0.0, 1.0], 1e-6) - 3.0).abs() < 1e-11);
        }
    }

    #[test]
    fn roots_are_found_where_newton_leaves_the_bracket() {
        // Newton's method alone runs away from the flat ends of this curve.
        for zero in [-0.9, 0.0, 0.4] {
            let at = |x: f64| [(9.0 * (x - zero)).atan(), 9.0 / (1.0 + 81.0 * (x - zero) * (x - zero))];
            for start in [-1.0, 0.2, 1.0] {
                assert!((root([-1.0, 1.0], start, at) - zero).abs() < 1e-13, "{zero} {start}");
            }
        }
        // A root at an end.
        assert!(root([0.0, 1.0], 0.5, |x| [x + 1.0, 1.0]) < 1e-14);
    }

    #[test]
    fn secants_narrow_a_bracket() {
        // Without half weights the low end would never move.
        let f = |x: f64| x * x * x * x - 0.1;
        let mut bracket = SecantBracket::new([0.0, 1.0], [0.0, 1.0].map(f));
        let mut steps = 0;
        while f(bracket.next()).abs() > 1e-12 {
            let x = bracket.next();
            bracket.take(x, f(x));
            steps += 1;
            assert!(f(bracket.ends[0]) < 0.0 && f(bracket.ends[1]) >= 0.0);
        }
        assert!(steps < 15, "{steps}");
    }

    #[test]
    fn secants_find_roots_and_stay_within_reach() {
        let end = SecantEnd { steps: 20, exact: 1e-12, level: 1e-14 };
        assert!((secant([1.0, 1.1], 1.0, end, |x| x * x - 2.0) - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((secant([1.0, 1.1], 0.5, end, |x| x * x + 2.0) - 1.0).abs() <= 0.5);
        assert_eq!(secant([1.0, 1.1], 0.5, end, |_| 3.0), 1.1);
    }
}
