"""Social groups: people who walk together (Moussaïd et al. 2010), and people who stop.

The forces between strangers and from walls are those of `social-force`. A member of a group feels
three more (Moussaïd, Perozo, Garnier, Helbing and Theraulaz, "The walking behaviour of pedestrian
social groups and its impact on crowd dynamics", PLoS ONE 5(4), e10047): it slows down if the others
are behind it, it is attracted by the centre of the group, and it keeps a distance to each member.
Strengths and distances are the paper's. A ramp replaces the paper's step at the distance where the
attraction begins, because a force that is switched every 0.2 s shakes the members.

Groups consist of agents of one team whose starts and goals are near each other, and that enter
the arena within 2 s of each other. Their sizes are drawn from shares; by default those of the
zero-truncated Poisson distribution that the paper fits to people on a working day (λ = 0.83; on a
Saturday 1.11: `[0.55, 0.3, 0.11, 0.04]`). A group prefers the mean of its members' preferred
speeds.

Groups stop at the events of a Poisson process, and stand for an exponentially distributed time.
This rule and its defaults are this project's own. Standing people still give way to others.
"""
