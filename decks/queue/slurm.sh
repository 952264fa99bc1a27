#!/bin/bash
# one run that may need more than its time limit:  sbatch slurm.sh DECK RESULTS
#SBATCH --job-name=crashsolve
#SBATCH --time=01:00:00
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem=2G
# the shell is notified two minutes before the end, which is enough time for a dump
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x.%j.txt
deck=$1 results=$2
out_of_time=no
trap 'out_of_time=yes; kill -TERM "$run"' USR1
trap 'kill -TERM "$run"' TERM

# without a dump in the folder, --restart starts from the beginning
${CRASHSOLVE:-crashsolve} "$deck" -o "$results" --restart &
run=$!
# the signal arrived before the run was started
[ "$out_of_time" = no ] || kill -TERM "$run"
wait "$run"; code=$?
# a trap ends the wait, not the run
while kill -0 "$run" 2>/dev/null; do wait "$run"; code=$?; done

# 3: stopped on request, with a dump to continue from; 143: stopped before it began, nothing is lost
if [ "$out_of_time" = yes ] && { [ "$code" -eq 3 ] || [ "$code" -eq 143 ]; }; then
    scontrol requeue "$SLURM_JOB_ID" && exit 0
fi
exit "$code"
