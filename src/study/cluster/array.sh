# Runs one of the @TASKS@ tasks of this study. Slurm sends a signal before the time limit, and when it
# needs the machine. The program then keeps its finished trials and exits with code 75. The task goes
# back into the queue, unless it was cancelled.
@PROGRAM@ study task . "$SLURM_ARRAY_TASK_ID" --jobs "${SLURM_CPUS_PER_TASK:-1}" --quiet &
task=$!
trap 'stopped=yes; kill -TERM "$task"' USR1 TERM
wait "$task"
code=$?
if [ -n "${stopped:-}" ]; then
    wait "$task"
    code=$?
fi
if [ "$code" -eq 75 ]; then
    me="${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}"
    if [ "$(squeue --noheader --jobs="$me" --states=RUNNING --format=%T)" = RUNNING ]; then
        scontrol requeue "$me"
    fi
fi
exit "$code"
