//! Decision tables: the action for the next changes of two operands and the order of these changes along the ray.

use crate::single_hit::{GateOp, Next, ValueStep, Verdict, decide};

/// The boolean operators of the original algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Inside if either operand is.
    Union,
    /// Inside if both operands are.
    Intersection,
    /// Inside if the first operand is and the second is not.
    Difference,
}

impl Operator {
    /// All of them, in the order of the tables.
    pub const ALL: [Operator; 3] = [Operator::Union, Operator::Intersection, Operator::Difference];

    /// The side of the result for the sides of the operands (true: inside).
    pub fn of(self, first: bool, second: bool) -> bool {
        match self {
            Operator::Union => first || second,
            Operator::Intersection => first && second,
            Operator::Difference => first && !second,
        }
    }
}

/// The kind of an operand's next change. An operand that is inside forever has an exit at +inf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// The ray enters the operand.
    Enter,
    /// The ray exits from the operand.
    Exit,
    /// Neither: the ray is outside the operand forever.
    Miss,
}

impl State {
    /// All of them, in the order of the tables.
    pub const ALL: [State; 3] = [State::Enter, State::Exit, State::Miss];

    /// The state of a next change.
    pub fn of(next: Next) -> State {
        match next {
            Next::Enter(_) => State::Enter,
            Next::Exit(_) | Next::Inside => State::Exit,
            Next::Outside => State::Miss,
        }
    }

    /// A next change with this state, at time `t`.
    fn sample(self, t: f64) -> Next {
        match self {
            State::Enter => Next::Enter(t),
            State::Exit => Next::Exit(t),
            State::Miss => Next::Outside,
        }
    }
}

/// An action. Its number is its nibble in the packed tables.
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

/// Packed decision tables: one per operator for the case that the first operand changes first, and one for the
/// case that the second does. Entry (first, second) is nibble `3 first + second`, counted from the lowest; nibble 8
/// does not fit into 32 bits and is always [`Action::Miss`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tables([[u32; 3]; 2]);

impl Tables {
    /// The tables derived from the rule ([`decide`]), for operands that never change at the same time.
    pub fn from_rule() -> Tables {
        Tables::pack(|operator, first_closer, first, second| {
            let (near, far) = (1.0, 2.0);
            let a = first.sample(if first_closer { near } else { far });
            let b = second.sample(if first_closer { far } else { near });
            action_of(operator, a, b)
        })
    }

    /// The tables of Opticks.
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
            // nibble 8 is shifted out: its action is 0
            let nibble = action << (4 * (3 * first as u32 + second as u32));
            packed[usize::from(!first_closer)][operator as usize] |= nibble as u32;
        }
        Tables(packed)
    }

    /// All keys of the tables: the operator, whether the first operand is closer, and the two states.
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

    /// The packed tables: those for a closer first operand, then those for a closer second operand, each in
    /// the order of [`Operator::ALL`].
    pub fn packed(&self) -> [[u32; 3]; 2] {
        self.0
    }
}

/// The action of the rule ([`decide`]) for the next changes `a` and `b` of the operands.
fn action_of(operator: Operator, a: Next, b: Next) -> Action {
    let inverts = operator == Operator::Difference;
    let second = if inverts { b.complement() } else { b };
    let least = if operator == Operator::Union { 1 } else { 2 };
    match decide(GateOp::AtLeast { least, most: [1, 1] }, a.into(), second.into()) {
        Verdict::Fixed(_) => Action::Miss,
        Verdict::Changes(ValueStep { t, .. }) if t == a.time() => Action::First,
        Verdict::Changes(_) if inverts => Action::FlippedSecond,
        Verdict::Changes(_) => Action::Second,
        Verdict::QueryAgain { first: true, .. } => Action::LoopFirst,
        Verdict::QueryAgain { .. } => Action::LoopSecond,
    }
}
