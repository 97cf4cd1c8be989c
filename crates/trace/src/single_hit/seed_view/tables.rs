//! Decision tables: from the next changes of two operands, and which of them is closer, to an action.

use crate::single_hit::{GateOp, Next, ValueStep, Verdict, decide};

/// The operators of the original.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// In either.
    Union,
    /// In both.
    Intersection,
    /// In the first, not in the second.
    Difference,
}

impl Operator {
    /// All of them, in the order of the tables.
    pub const ALL: [Operator; 3] = [Operator::Union, Operator::Intersection, Operator::Difference];

    /// True if the result is inside, for the sides of the operands.
    pub fn of(self, first: bool, second: bool) -> bool {
        match self {
            Operator::Union => first || second,
            Operator::Intersection => first && second,
            Operator::Difference => first && !second,
        }
    }
}

/// The next change of an operand; an exit at +inf is an exit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It is entered.
    Enter,
    /// It is exited.
    Exit,
    /// Neither: the ray is outside forever.
    Miss,
}

impl State {
    /// All of them, in the order of the tables.
    pub const ALL: [State; 3] = [State::Enter, State::Exit, State::Miss];

    /// The column of the tables for a next change.
    pub fn of(next: Next) -> State {
        match next {
            Next::Enter(_) => State::Enter,
            Next::Exit(_) | Next::Inside => State::Exit,
            Next::Outside => State::Miss,
        }
    }

    /// A next change with this state.
    fn sample(self, t: f64) -> Next {
        match self {
            State::Enter => Next::Enter(t),
            State::Exit => Next::Exit(t),
            State::Miss => Next::Outside,
        }
    }
}

/// An action. The numbers are those of the packed tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Action {
    /// Return a miss.
    Miss = 0,
    /// Return the change of the first operand.
    First = 1,
    /// Return the change of the second operand.
    Second = 2,
    /// Return the change of the second operand with enter and exit exchanged.
    FlippedSecond = 3,
    /// Query the first operand again, after the time of its change.
    LoopFirst = 4,
    /// Query the second operand again, after the time of its change.
    LoopSecond = 5,
}

impl Action {
    const ALL: [Action; 6] = [
        Action::Miss,
        Action::First,
        Action::Second,
        Action::FlippedSecond,
        Action::LoopFirst,
        Action::LoopSecond,
    ];
}

/// A table for each operator, packed, for a closer first operand and for a closer second one. Entry
/// (first, second) is the nibble number 3 first + second; number 8 is always [`Action::Miss`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tables([[u32; 3]; 2]);

impl Tables {
    /// The tables that follow from the rule, for operands whose times are never equal.
    pub fn from_rule() -> Tables {
        Tables::pack(|operator, first_closer, first, second| {
            let (near, far) = (1.0, 2.0);
            let a = first.sample(if first_closer { near } else { far });
            let b = second.sample(if first_closer { far } else { near });
            action_of(operator, a, b)
        })
    }

    /// The original tables.
    ///
    /// Each entry is (action if the first is closer, action if the second is closer), for the states of the
    /// two operands in the order of [`State::ALL`].
    pub fn original() -> Tables {
        use Action::{
            First as A, FlippedSecond as FlipB, LoopFirst as LoopA, LoopSecond as LoopB, Miss as Non,
            Second as B,
        };
        let union =
            [[(A, B), (LoopA, B), (A, A)], [(A, LoopB), (B, A), (A, A)], [(B, B), (B, B), (Non, Non)]];
        let intersection = [
            [(LoopA, LoopB), (A, LoopB), (Non, Non)],
            [(LoopA, B), (A, B), (Non, Non)],
            [(Non, Non), (Non, Non), (Non, Non)],
        ];
        let difference = [
            [(A, LoopB), (LoopA, LoopB), (A, A)],
            [(A, FlipB), (LoopA, FlipB), (A, A)],
            [(Non, Non), (Non, Non), (Non, Non)],
        ];
        let all = [union, intersection, difference];
        Tables::pack(|operator, first_closer, first, second| {
            let entry = all[operator as usize][first as usize][second as usize];
            if first_closer { entry.0 } else { entry.1 }
        })
    }

    fn pack(entry: impl Fn(Operator, bool, State, State) -> Action) -> Tables {
        let mut packed = [[0u32; 3]; 2];
        for (operator, first_closer, first, second) in Tables::keys() {
            let action = u64::from(entry(operator, first_closer, first, second) as u32);
            // the ninth entry is shifted out: it is 0
            let nibble = action << (4 * (3 * first as u32 + second as u32));
            packed[usize::from(!first_closer)][operator as usize] |= nibble as u32;
        }
        Tables(packed)
    }

    /// All keys of the tables: operator, "the first is closer", the two states.
    pub fn keys() -> impl Iterator<Item = (Operator, bool, State, State)> {
        let states = State::ALL.into_iter().flat_map(|a| State::ALL.into_iter().map(move |b| (a, b)));
        let closer = states.flat_map(|(a, b)| [true, false].into_iter().map(move |first| (first, a, b)));
        closer
            .flat_map(|(first, a, b)| Operator::ALL.into_iter().map(move |operator| (operator, first, a, b)))
    }

    /// The action for a key.
    pub fn look_up(&self, operator: Operator, first_closer: bool, first: State, second: State) -> Action {
        let packed = u64::from(self.0[usize::from(!first_closer)][operator as usize]);
        let nibble = packed >> (4 * (3 * first as u32 + second as u32)) & 0xf;
        Action::ALL.get(nibble as usize).copied().unwrap_or(Action::Miss)
    }

    /// The packed numbers: those for a closer first operand, then those for a closer second one, each in the
    /// order of [`Operator::ALL`].
    pub fn packed(&self) -> [[u32; 3]; 2] {
        self.0
    }
}

/// The action that the rule yields.
fn action_of(operator: Operator, a: Next, b: Next) -> Action {
    let inverts = operator == Operator::Difference;
    let taken = if inverts { b.complement() } else { b };
    let least = if operator == Operator::Union { 1 } else { 2 };
    match decide(GateOp::AtLeast { least, most: [1, 1] }, a.into(), taken.into()) {
        Verdict::Fixed(_) => Action::Miss,
        Verdict::Changes(ValueStep { t, .. }) if t == a.time() => Action::First,
        Verdict::Changes(_) if inverts => Action::FlippedSecond,
        Verdict::Changes(_) => Action::Second,
        Verdict::QueryAgain { first: true, .. } => Action::LoopFirst,
        Verdict::QueryAgain { .. } => Action::LoopSecond,
    }
}
