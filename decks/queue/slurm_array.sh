#!/bin/bash
# an array without a sweep, one deck of a list to each task:  sbatch slurm_array.sh LIST
# LIST has a deck in each line; results go to folders beside the list
#SBATCH --job-name=crashsolve
#SBATCH --array=1-8%4
#SBATCH --time=01:00:00
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem=2G
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x.%A_%a.txt
deck=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$1")
[ -n "$deck" ] || { echo "line $SLURM_ARRAY_TASK_ID of $1 names no deck"; exit 2; }
results="$(dirname "$1")/$(basename "$deck" .yaml).$SLURM_ARRAY_TASK_ID.results"
out_of_time=no
trap 'out_of_time=yes; kill -TERM "$run"' USR1
trap 'kill -TERM "$run"' TERM

${CRASHSOLVE:-crashsolve} "$deck" -o "$results" --restart &
run=$!
# the signal arrived before the run was started
[ "$out_of_time" = no ] || kill -TERM "$run"
wait "$run"; code=$?
while kill -0 "$run" 2>/dev/null; do wait "$run"; code=$?; done

if [ "$out_of_time" = yes ] && { [ "$code" -eq 3 ] || [ "$code" -eq 143 ]; }; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}" && exit 0
fi
exit "$code"
