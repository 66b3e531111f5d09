"""Measured campaigns: what a laboratory hands over, read, checked, written and looked at.

    from studies.campaigns import read
    campaign = read("block-3/campaign.toml")

A campaign is a folder with `campaign.toml` (the block as declared, the channels, the tests) and a CSV for each test;
SI units, angles in radians.  Whatever is wrong with it ends in one `CampaignError` before anything is computed.
`studies.campaigns.signals` has what the records say by themselves; `python -m studies.campaigns` shows a campaign.
"""

from studies.campaigns.errors import CampaignError
from studies.campaigns.model import Campaign, Channel, Conditions, DeclaredBlock, Test
from studies.campaigns.motions import motion_groups
from studies.campaigns.reading import read
from studies.campaigns.writing import write

__all__ = [
    "Campaign",
    "CampaignError",
    "Channel",
    "Conditions",
    "DeclaredBlock",
    "Test",
    "motion_groups",
    "read",
    "write",
]
