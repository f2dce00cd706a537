# An array job for Slurm: save these lines as array.sh, and submit them with `sbatch array.sh` in this
# folder, which all machines share. A task that exits with code 75 can be resumed: `xcscr study status`
# lists the open tasks, for `sbatch --array=LIST array.sh`. At the end: xcscr study report @FOLDER@
#SBATCH --array=1-@TASKS@
#SBATCH --time=1:00:00
#SBATCH --signal=B:TERM@60
exec xcscr study task @FOLDER@ "$SLURM_ARRAY_TASK_ID" --jobs "${SLURM_CPUS_PER_TASK:-1}" --quiet
