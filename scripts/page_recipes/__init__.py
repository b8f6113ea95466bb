"""How the figures of each page are measured: programs to run, texts to make of what they write."""
from . import calibration, contact, engines, filters, grasps, operators, people, reliability, stability, training
from .measuring import MeasurementError  # noqa: F401

RECIPES = {name: recipe for page in (calibration, contact, engines, filters, grasps, operators, people, reliability, stability, training)
           for name, recipe in page.RECIPES.items()}
