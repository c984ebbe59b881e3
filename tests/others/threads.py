"""Threads that ask what a restitution is in a program's terms, or why it is not what was written."""

from __future__ import annotations

_SAID = """
google-deepmind/mujoco#2080 | MuJoCo | open | restitution into solref and solimp
google-deepmind/mujoco#1741 | MuJoCo | open | N/m and N s/m into solref
google-deepmind/mujoco#1739 | MuJoCo | closed | physical units for contact parameters
google-deepmind/mujoco#732 | MuJoCo | closed | meaning of −stiffness and −damping
farmsim/farms_mujoco#21 | FARMS | open | units of solref's numbers
newton-physics/newton#743 | Newton | open | how to choose ke, kd, restitution
newton-physics/newton#1131 | Newton | open | restitution for AVBD's contacts
gazebosim/sdformat#396 | SDFormat | open | meaning of restitution of pairs
gazebosim/gazebo-classic#2273 | Gazebo Classic | open | kp, kd from erp and cfm
gazebosim/gazebo-classic#2904 | Gazebo Classic | open | restitution ignored by DART
gazebosim/gz-physics#84 | Gazebo Physics | open | restitution ignored at collisions
gazebosim/gz-sim#1961 | Gazebo Sim | open | kp and kd without effect
mtiller/ModelicaBook#487 | Modelica | open | tuning ElastoGap's spring and damper
RobotLocomotion/drake#16444 | Drake | open | unit and meaning of dissipation
isaac-sim/IsaacLab#2434 | Isaac Lab | open | restitution of a rigid object
isaac-sim/IsaacLab#4432 | Isaac Lab | open | compliant stiffness, damping without effect
google/brax#317 | Brax | open | contacts that are not physical
bepu/bepuphysics2#52 | bepuphysics | open | restitution from spring settings
duburcqa/jiminy#36 | jiminy | open | rigid impact, no spring–damper
duburcqa/jiminy#617 | jiminy | open | spring–damper beside constraints
bow-simulation/virtualbow#112 | VirtualBow | open | contact damping as in ADAMS
erdnaxe/kraby#2 | PyBullet | open | contact stiffness and damping values
bulletphysics/bullet3#4428 | PyBullet | closed | how to set contact stiffness
OpenSees/OpenSees#445 | OpenSees | closed | documentation of three impact materials
lammps/lammps#4068 | LAMMPS | closed | damping by coefficient of restitution
lammps/lammps#4180 | LAMMPS | closed | NaN with coeff_restitution and cohesion
lammps/lammps#2812 | LAMMPS | closed | restitution not as damping says
projectchrono/chrono#221 | Chrono | closed | code with a wrong restitution
simbody/simbody#725 | Simbody | closed | how dissipations of pairs combine
"""
#: by repository and number, open or closed as in a copy of the forge of autumn 2026
THREADS = tuple(
    dict(zip(("thread", "program", "state", "asks"), line.split(" | "), strict=True))
    for line in _SAID.strip().splitlines()
)
