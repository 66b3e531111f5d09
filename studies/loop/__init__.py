"""Closing the loop with measured data: from the residual between model and measurement to the effect that was missing.

    python -m studies.loop CAMPAIGN.toml --out DIR
    python -m studies.loop predict DIR/model.toml CAMPAIGN.toml --out DIR2

The model is calibrated first, as a careful engineer would (restitution, leans at release).  What is left over is traced
to an effect of `rocking.effects`, which is fitted and compared with its rivals; errors before and after are reported on
tests that neither the fit nor the choice saw.

Rooms, each standing on those before it: `models`, `runs` of them, what is `observed`, `fits`, the `records` of a
campaign, what its `swings` and its `whole` records tell, the `search`; then `closing`, and what is written of it.
"""
