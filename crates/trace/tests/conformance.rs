//! The conformance suite for all evaluators.

use rayweave_conformance::conformance_tests;
use rayweave_model::Program;
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::sync::Arc;

mod weave {
    use super::*;
    conformance_tests!(Weave::new, Reference::new);
}

mod reference {
    use super::*;
    conformance_tests!(Reference::new);
}

mod single_hit {
    use super::*;

    fn single_hit(program: Arc<Program>) -> SingleHit {
        SingleHit::new(program).expect("no model of the suite is too large")
    }

    conformance_tests!(single_hit, Reference::new);
}

mod packets {
    use super::*;
    conformance_tests!(Packets::new, Reference::new);
}

mod spans {
    use super::*;
    conformance_tests!(Spans::new, Reference::new);
}
