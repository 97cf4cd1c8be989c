"""Runs the sample on which the types are checked."""

import typed_sample


def test_the_sample_runs():
    typed_sample.main()
