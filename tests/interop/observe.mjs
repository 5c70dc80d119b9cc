// A ROS 2 node in TypeScript, independent of Fast DDS and of ROS: lists the topics that it discovers with their ROS
// types and decodes one message of each named topic.
//
//   node observe.mjs [--seconds S] [--listed TOPIC=TYPE]... TOPIC=TYPE...  for example /tf=tf2_msgs/msg/TFMessage
//
// Prints one JSON object {topics: {name: type}, messages: {name: summary}}. Status 0: every named topic was found with
// its type, and one message was decoded of each that is not just to be --listed; 1: not within the time.
import { createRequire } from "node:module";

const require = createRequire(process.env.LAPIS_NODE_MODULES ? `${process.env.LAPIS_NODE_MODULES}/` : import.meta.url);
const { RosNode } = require("@foxglove/ros2");
const { UdpSocketNode } = require("@foxglove/ros2/nodejs");
const { Participant, Durability, Reliability, HistoryKind } = require("@foxglove/rtps");
const { ros2jazzy } = require("@foxglove/rosmsg-msgs-common");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const LOOPBACK = "127.0.0.1";
const PEERS = 32; // participants per host that announcements reach, as with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
const domain = Number(process.env.ROS_DOMAIN_ID ?? 0);
const discoveryPort = (participant) => 7410 + 250 * domain + 2 * participant;

// The package knows multicast discovery only, and announces itself once: a process that is just starting and does not
// listen yet would never hear of it. This socket does what LOCALHOST asks for: announcements go to each possible
// participant of this host, again every second as RTPS has it, and we listen where the others' announcements go.
function loopbackSockets(participantId) {
  return async (options) => {
    const socket = await UdpSocketNode.Create({ ...options, reuseAddr: false });
    const [send, bind] = [socket.send.bind(socket), socket.bind.bind(socket)];
    const announce = async (data) => {
      for (let peer = 0; peer < PEERS; ++peer) await send(data, 0, data.length, discoveryPort(peer), LOOPBACK);
    };
    socket.bind = (where) => bind({ address: LOOPBACK, port: where.port ? 0 : discoveryPort(participantId) });
    socket.addMembership = async () => {};
    socket.send = async (data, offset, length, port, address) => {
      if (!address.startsWith("239.")) return send(data, offset, length, port, address);
      const announcement = data.slice(offset, offset + length);
      setInterval(() => announce(announcement), 1000);
      return announce(announcement);
    };
    return socket;
  };
}

function definitionsOf(type) {
  const all = [];
  const visit = (name) => {
    const definition = ros2jazzy[name];
    if (!definition) throw new Error(`no Jazzy definition of ${name}`);
    if (all.includes(definition)) return;
    all.push(definition);
    for (const field of definition.definitions) if (field.isComplex) visit(field.type);
  };
  visit(type.replace("/msg/", "/"));
  return all.map((definition, i) => (i === 0 ? { ...definition, name: undefined } : definition));
}

function summary(message) {
  const image = message.data?.byteLength !== undefined && { ...message, data: `${message.data.byteLength} bytes` };
  return JSON.parse(JSON.stringify(image || message, (_, v) => {
    if (typeof v === "bigint") return Number(v);
    return ArrayBuffer.isView(v) && !(v instanceof DataView) ? Array.from(v) : v;
  }));
}

const parameters = process.argv.slice(2);
const secondsAt = parameters.indexOf("--seconds");
const seconds = secondsAt < 0 ? 20 : Number(parameters.splice(secondsAt, 2)[1]);
const listed = new Map();
for (let at = parameters.indexOf("--listed"); at >= 0; at = parameters.indexOf("--listed")) {
  listed.set(...parameters.splice(at, 2)[1].split("="));
}
const wanted = new Map(parameters.map((text) => text.split("=")));

const node = new RosNode({ name: "observer", domainId: domain, addresses: [LOOPBACK], udpSocketCreate: loopbackSockets(30) });
// RosNode asks for TRANSIENT_LOCAL only, which a VOLATILE writer does not offer, so data goes over a plain participant.
const reader = new Participant({
  name: "reader", domainId: domain, addresses: [LOOPBACK], udpSocketCreate: loopbackSockets(31),
});
const messages = {};
reader.on("userData", (data) => {
  const topic = data.subscription.topicName.slice(2);
  if (messages[topic] || !wanted.has(topic)) return;
  messages[topic] = summary(new MessageReader(definitionsOf(wanted.get(topic))).readMessage(data.serializedData));
});
await node.start();
await reader.start();
for (const [topic, type] of wanted) {
  const [pkg, , name] = type.split("/");
  reader.subscribe({
    topicName: `rt${topic}`,
    typeName: `${pkg}::msg::dds_::${name}_`,
    durability: Durability.Volatile,
    reliability: { kind: Reliability.Reliable, maxBlockingTime: { sec: 1, nsec: 0 } },
    history: { kind: HistoryKind.KeepLast, depth: 5 },
  });
}
process.stderr.write("observer: ready\n");

const begin = Date.now();
const isComplete = () => {
  const topics = new Map(node.getPublishedTopics());
  const isListed = ([topic, type]) => topics.get(topic) === type;
  return [...listed, ...wanted].every(isListed) && [...wanted.keys()].every((topic) => messages[topic]);
};
const timer = setInterval(() => {
  if (!isComplete() && Date.now() - begin < 1000 * seconds) return;
  clearInterval(timer);
  console.log(JSON.stringify({ topics: Object.fromEntries(node.getPublishedTopics()), messages }, null, 1));
  process.exit(isComplete() ? 0 : 1);
}, 50);
