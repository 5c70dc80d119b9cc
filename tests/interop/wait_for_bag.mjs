// Waits until metadata.yaml of a bag tells of some messages: node wait_for_bag.mjs BAG TOPIC NUMBER. The folder has to exist.
// Status 1: not within 30 s.
import { readFileSync, watch } from "node:fs";
import { join } from "node:path";

const [bag, topic, number] = process.argv.slice(2);

function look() {
  let metadata = "";
  try {
    metadata = readFileSync(join(bag, "metadata.yaml"), "utf8");
  } catch {
    return; // it is not written yet
  }
  const told = metadata.match(new RegExp(`name: ${topic}\\n[\\s\\S]*?message_count: (\\d+)`));
  if (told && Number(told[1]) >= Number(number)) process.exit(0);
}

watch(bag, look);
look();
setTimeout(() => process.exit(1), 30_000);
