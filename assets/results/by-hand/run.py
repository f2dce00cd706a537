import json, subprocess
from pathlib import Path
import hydra
from hydra.core.hydra_config import HydraConfig

@hydra.main(version_base=None, config_path=".", config_name="config")
def main(cfg):
    out = Path(HydraConfig.get().runtime.output_dir)
    command = ["xcscr", "train", cfg.world, "--method", cfg.method, "--arena", "grid", "--seed", str(cfg.seed),
               "--episodes", "180", "--record", "none", "--json", "--quiet", "--out", str(out / "run")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    result = json.loads(done.stdout)
    (out / "result.json").write_text(json.dumps(dict(cfg) | result))

if __name__ == "__main__":
    main()
