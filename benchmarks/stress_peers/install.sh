#!/usr/bin/env bash
# Create an environment for each peer (search to compare with) of stress_dimensions.py, outside the repository:
# install.sh [FOLDER]
set -euo pipefail
home=${1:-$HOME/.cache/tarl-stress-peers}
python=${PYTHON:-python3}
mkdir -p "$home"
"$python" -m venv "$home/psy_taliro"
"$home/psy_taliro/bin/pip" install --quiet psy-taliro==3.2.0
"$python" -m venv "$home/stgem"
# STGEM's other requirements (tensorflow, fmpy, sphinx, …) are needed only by parts of STGEM that are not used here
"$home/stgem/bin/pip" install --quiet "torch~=2.2.1" "numpy<2" pandas scipy "dill~=0.3.4" "joblib~=1.3.2" \
    matplotlib alive_progress antlr4-python3-runtime==4.13.0 scikit-learn gymnasium bunch_py3
"$home/stgem/bin/pip" install --quiet --no-deps stgem==2.0.1
