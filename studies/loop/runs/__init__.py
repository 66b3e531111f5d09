"""Many runs of many models on the tests of a campaign, with base motions thinned, and kept where work was cut off."""
