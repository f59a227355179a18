"""The reward, agent by agent, from Eq. 2-10 of the paper."""

from benchnav.arena.solid import Kind

WEIGHTS = {
    Kind.STATIC: "static", Kind.DYNAMIC: "dynamic", Kind.WALL: "walls", Kind.AGENT: "agents",
}  # fmt: skip


def terms(w, arrived, nearer, contacts, p, turned):
    """One agent's terms as they enter Eq. 2; ``contacts`` lists the kinds newly touched."""
    out = dict.fromkeys([*WEIGHTS.values(), "goal", "approach", "p_dynamic"], 0.0)
    danger = p > w.threshold
    if arrived and not danger:  # Eq. 3
        out["goal"] = w.goal
    if w.moving == "sign" and nearer > 0 and not danger:  # Eq. 4
        out["approach"] = w.approach
    if w.moving == "progress" and not (danger and nearer > 0):
        out["approach"] = w.approach * nearer
    for kind in contacts:  # Eq. 5-8
        out[WEIGHTS[kind]] -= getattr(w, WEIGHTS[kind])
    out["time"] = -w.time  # Eq. 9
    if danger:  # Eq. 10
        out["p_dynamic"] = -w.p_dynamic
    out["turning"] = -w.turning * turned
    return out
