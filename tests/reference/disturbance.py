"""Slow twin of `benchnav.metrics.quantities.disturbance`: one person and one step at a time.

Remaining ways are straight: it is for worlds without obstacles.
"""

import math


def expected_arrival(episode, agent, last):
    """(time [s], way [m]) until the goal, from what is known after ``last`` decisions."""
    dt, way = episode.world.clock.dt, 0.0
    for t in range(last):
        if episode.status[t, agent] != 0:
            break
        way += math.dist(episode.position[t, agent], episode.position[t + 1, agent])
    arrival = episode.arrival[agent]
    if arrival <= last * dt + 1e-9:
        return arrival, way
    agents = episode.world.agents
    away = math.dist(episode.position[last, agent], agents.goal[agent])
    rest = max(away - episode.world.rules.goal_tolerance, 0.0)
    return last * dt + rest / agents.preferred_speed[agent], way + rest


def disturbance(episode, undisturbed):
    """(delays [s], detours [m]) of all people."""
    people = [a for a in range(len(episode.arrival)) if episode.world.agents.driver[a] > 0]
    delays, detours = [], []
    for place, agent in enumerate(people):
        last = len(episode.requested)
        if math.isnan(undisturbed.arrival[place]):
            last = min(last, len(undisturbed.requested))
        time, way = expected_arrival(episode, agent, last)
        usual_time, usual_way = expected_arrival(undisturbed, place, last)
        delays.append(time - usual_time)
        detours.append(way - usual_way)
    return delays, detours
