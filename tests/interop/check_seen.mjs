// Judges the messages that observe.mjs saw of camera, slam and semantic_mapper: node check_seen.mjs SEEN.json
import assert from "node:assert";
import { readFileSync } from "node:fs";

const { topics, messages } = JSON.parse(readFileSync(process.argv[2]));
const odometry = messages["/slam/odometry"];
assert.strictEqual(odometry.header.frame_id, "map");
assert.strictEqual(odometry.child_frame_id, "base_link");
const q = odometry.pose.pose.orientation;
assert(Math.abs(Math.hypot(q.x, q.y, q.z, q.w) - 1) < 1e-6);
assert.strictEqual(odometry.pose.covariance.length, 36);
const image = messages["/camera/color/image_raw"];
assert.deepStrictEqual([image.width, image.height, image.encoding, image.step], [320, 240, "rgb8", 960]);
assert.strictEqual(image.data, "230400 bytes");
assert.strictEqual(image.header.frame_id, "camera_color_optical_frame");
assert(!Object.keys(topics).some((name) => name.includes("tiles")), "keyed topics are plain DDS");
console.log(`${Object.keys(topics).length} topics listed with ROS types; ${Object.keys(messages).length} decoded`);
