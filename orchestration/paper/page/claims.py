"""The section of a page with the claims of the paper: verdict, criterion, what was measured, and the margin."""

from collections import Counter
from collections.abc import Mapping, Sequence

from markupsafe import Markup

from orchestration.paper.claims.claim import HOLDS, Claim
from orchestration.report.markup import table
from orchestration.report.page import Section
from orchestration.report.tables import paragraph

HEAD = ("claim", "what the paper says", "in words", "criterion and margin", "measured", "runs")


def claims_section(claims: Sequence[Claim], words: Mapping[str, str]) -> Section:
    """The table of claims.

    Parameters
    ----------
    words
        How strongly each claim holds, in a phrase, by claim.
    """
    verdicts = Counter(claim.verdict for claim in claims)
    lead = f"{verdicts[HOLDS]} of {len(claims)} claims hold at the calibration. The criteria were fixed beforehand."
    rows = [
        (
            claim.id,
            Markup("{} <small>({})</small>").format(claim.claim, claim.where),
            Markup('<span class="{}">{}</span>').format("good" if claim.verdict == HOLDS else "bad", words[claim.id]),
            Markup("<br>").join([claim.criterion, *claim.margins]),
            claim.measured,
            claim.runs,
        )
        for claim in claims
    ]
    return Section("claims", "Claims of the paper", paragraph(lead) + table(HEAD, rows))
