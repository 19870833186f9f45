"""What accuracy, an integrator or a model costs, measured: branches, a motion, margins."""
