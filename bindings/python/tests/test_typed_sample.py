"""The sample that the types are checked on runs, too."""

import typed_sample


def test_the_sample_runs():
    typed_sample.main()
