"""The section of a page with the claims of the paper: verdict, criterion, what was measured, and the margin."""

from collections import Counter
from collections.abc import Mapping, Sequence

from markupsafe import Markup

from orchestration.paper.claims.claim import HOLDS, Claim
from orchestration.report.page import Section
from orchestration.report.tables import paragraph

CARD = Markup(
    '<details class="run"><summary><b>{id}</b> <span class="{kind}">{word}</span>: {claim} ({where})</summary>'
    "<p>Criterion: {criterion}.</p><p>Measured: {measured}.</p><p>Margins: {margins}.</p><p>Runs: {runs}.</p></details>"
)


def claims_section(claims: Sequence[Claim], words: Mapping[str, str]) -> Section:
    """The claims, each folded: its verdict and sentence, and below the criterion, what was measured, and margins.

    Parameters
    ----------
    words
        How strongly each claim holds, in a phrase, by claim.
    """
    verdicts = Counter(claim.verdict for claim in claims)
    lead = f"{verdicts[HOLDS]} of {len(claims)} claims hold at the calibration. The criteria were fixed beforehand."
    cards = [
        CARD.format(
            id=claim.id,
            kind="good" if claim.verdict == HOLDS else "bad",
            word=words[claim.id],
            claim=claim.claim,
            where=claim.where,
            criterion=claim.criterion,
            measured=claim.measured,
            margins="; ".join(claim.margins),
            runs=claim.runs,
        )
        for claim in claims
    ]
    return Section("claims", "Claims of the paper", paragraph(lead) + Markup().join(cards))
