"""Functions passed to a library: their results are in the result of this or a later call of the library."""

import functools
import heapq
from concurrent.futures import ThreadPoolExecutor
from itertools import accumulate, groupby
from multiprocessing import Pool

import casadi_like
import joblib
import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, differential_evolution, least_squares, minimize
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, Float64MultiArray


class Residual:
    """A callable object, which the library calls."""

    def __init__(self, planner):
        self.planner = planner

    def __call__(self, guess):
        return guess - self.planner.speed


class Planner:
    def __init__(self):
        self.speed = self.goal = self.heading = self.load = 0.0
        self.ranges = []
        self.bias = 1.0
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        self.solver = casadi_like.Solver("ipopt", objective=self.objective)
        self.table = casadi_like.Table()
        self.table.set_rule(self.rule)
        self.curve = np.vectorize(self.shape)
        rospy.Subscriber("speed", Float64, self.on_speed)  # source speed
        rospy.Subscriber("goal", PoseStamped, self.on_goal)  # source goal
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("load", Float64, self.on_load)  # source load
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_speed(self, msg):
        self.speed = msg.data

    def on_goal(self, msg):
        self.goal = msg.pose.position.x

    def on_scan(self, msg):
        self.ranges = msg.ranges

    def on_load(self, msg):
        self.load = msg.data

    def objective(self, u):
        return (u[0] - self.goal) ** 2

    def rule(self, key):
        return self.load

    def shape(self, v):
        return v * self.speed

    def dynamics(self, t, state, force):
        yield self.load * force
        yield state[0]

    def blind(self, u):
        return u[0] * self.bias

    def step(self, total, reading):
        return total + reading * self.load

    def note(self, best):
        self.out.publish(best[0])  # sink scan

    def tick(self, event):
        found = differential_evolution(self.objective, bounds=[(0.0, 1.0)])
        self.out.publish(found.x[0])  # sink goal
        self.out.publish(minimize(fun=self.blind, x0=[0.0]).x[0])  # clean
        self.out.publish(minimize(self.blind, x0=[self.speed]).x[0])  # sink speed
        self.out.publish(least_squares(Residual(self), 0.0).x)  # sink speed
        self.out.publish(brentq(functools.partial(self.step, 1.0), 0.0, 9.0))  # sink load
        whole, _ = quad(lambda r: r * self.goal, 0.0, 1.0)
        self.out.publish(whole)  # sink goal
        path = solve_ivp(self.dynamics, (0.0, 1.0), [0.0], args=(self.goal,))
        self.out.publish(path.y[0][-1])  # sink goal load
        self.out.publish(self.curve(2.0))  # sink speed
        self.out.publish(self.solver.solve([0.0])["x"])  # sink goal
        self.table.refresh()
        self.out.publish(self.table.best)  # sink load
        self.out.publish(functools.reduce(self.step, [1.0, 2.0], 0.0))  # sink load
        self.out.publish(list(accumulate([1.0, 2.0], self.step))[-1])  # sink load
        limits = [{"type": "ineq", "fun": lambda u: u[0] - self.speed}]
        self.out.publish(minimize(self.blind, [0.0], constraints=limits).x[0])  # sink speed
        minimize(self.blind, self.ranges, callback=self.note)
        with ThreadPoolExecutor() as pool:
            near = list(pool.map(self.shape, [1.0, 2.0]))
            far = pool.submit(self.blind, self.ranges).result()
        self.out.publish(near[0])  # sink speed
        self.out.publish(far)  # sink scan
        with Pool(2) as pool:
            self.out.publish(pool.starmap(self.step, [(0.0, 1.0)])[0])  # sink load
            later = pool.apply_async(self.shape, (1.0,))
            self.out.publish(later.get(timeout=1.0))  # sink speed
            self.out.publish(pool.map(len, ["a"])[0])  # clean
        several = joblib.Parallel(n_jobs=2)(joblib.delayed(self.shape)(v) for v in (1.0, 2.0))
        self.out.publish(several[0])  # sink speed
        self.out.publish(heapq.nsmallest(1, [1.0, 2.0], key=self.shape)[0])  # sink ~speed
        groups = [list(g) for _, g in groupby([1.0, 2.0], key=self.rule)]
        self.out.publish(groups[0][0])  # sink ~load
        rows = np.apply_along_axis(self.blind, 0, np.array(self.ranges))
        Float64MultiArray(data=list(rows))
        self.out.publish(np.fromfunction(self.shape, (2,))[0])  # sink speed
        self.out.publish(np.fromfunction(lambda i: i * self.bias, (2,))[0])  # clean


if __name__ == "__main__":
    rospy.init_node("planner")
    Planner()
    rospy.spin()
