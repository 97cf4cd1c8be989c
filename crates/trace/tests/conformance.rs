//! Both evaluators pass the suite.

use rayweave_conformance::conformance_tests;
use rayweave_trace::{Reference, Weave};

mod weave {
    use super::*;
    conformance_tests!(Weave::new, Reference::new);
}

mod reference {
    use super::*;
    conformance_tests!(Reference::new);
}
