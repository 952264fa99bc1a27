#!/bin/bash
# one run that may need more than its time limit:
#     qsub -v DECK=deck.yaml,RESULTS=deck.results pbs.sh
# or the runs of a sweep that `crashsolve sweep PLAN -o DIR --slurm` has prepared:
#     qsub -v SWEEP=DIR -J 1-64 pbs.sh
#PBS -N crashsolve
#PBS -l select=1:ncpus=1:mem=2gb
#PBS -l walltime=01:00:00
#PBS -j oe
cd "$PBS_O_WORKDIR" || exit 1
# PBS sends no signal before the time limit: the script has its own limit [s], two minutes shorter
limit=${LIMIT:-3480}
run_of_sweep=${RUN:-$PBS_ARRAY_INDEX}
trap 'kill -TERM "$run"' TERM

if [ -n "$SWEEP" ]; then
    ${CRASHSOLVE:-crashsolve} sweep "$SWEEP" --run "$run_of_sweep" &
else
    ${CRASHSOLVE:-crashsolve} "$DECK" -o "$RESULTS" --restart &
fi
run=$!
begun=$SECONDS out_of_time=no
while kill -0 "$run" 2>/dev/null; do
    if [ $((SECONDS - begun)) -ge "$limit" ] && [ "$out_of_time" = no ]; then
        out_of_time=yes
        kill -TERM "$run"
    fi
    sleep 1
done
wait "$run"; code=$?

# 3: stopped on request, with a dump to continue from; 143: stopped before it began, nothing is lost
if [ "$out_of_time" = yes ] && { [ "$code" -eq 3 ] || [ "$code" -eq 143 ]; }; then
    next="LIMIT=$limit,DECK=$DECK,RESULTS=$RESULTS,SWEEP=$SWEEP,RUN=$run_of_sweep"
    qsub -v "$next" "${SCRIPT:-pbs.sh}" && exit 0
fi
exit "$code"
