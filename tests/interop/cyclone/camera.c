// A camera on Cyclone DDS that publishes images and camera infos by best effort, as many drivers do: a wall with random
// dots, 2 m in front of a camera that stands still. 10 Hz until SIGTERM.
#include <dds/dds.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "camera_types.h"

enum { kWidth = 320, kHeight = 240, kDot = 4 };

static volatile sig_atomic_t stopped = 0;
static void stop(int signal) {
  (void)signal;
  stopped = 1;
}

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
  exit(2);
}

static dds_entity_t writer(dds_entity_t participant, const char* name, const dds_topic_descriptor_t* type,
                           bool is_latched) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, is_latched ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_durability(qos, is_latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 5);
  const dds_entity_t topic = checked(dds_create_topic(participant, type, name, NULL, NULL), name);
  const dds_entity_t result = checked(dds_create_writer(participant, topic, qos, NULL), name);
  dds_delete_qos(qos);
  return result;
}

static void write_sample(dds_entity_t writer, const void* sample) { checked(dds_write(writer, sample), "write"); }

static std_msgs_msg_dds__Header_ header_at(dds_time_t now) {
  std_msgs_msg_dds__Header_ header = {.frame_id = "camera_color_optical_frame"};
  header.stamp.sec = (int32_t)(now / DDS_NSECS_IN_SEC);
  header.stamp.nanosec = (uint32_t)(now % DDS_NSECS_IN_SEC);
  return header;
}

static sensor_msgs_msg_dds__Image_ image_of(const char* encoding, uint32_t bytes_per_pixel) {
  sensor_msgs_msg_dds__Image_ image = {.width = kWidth, .height = kHeight, .encoding = (char*)encoding};
  image.step = kWidth * bytes_per_pixel;
  image.data._length = image.data._maximum = image.step * kHeight;
  image.data._buffer = calloc(image.data._length, 1);
  return image;
}

static void draw_wall(sensor_msgs_msg_dds__Image_* color, sensor_msgs_msg_dds__Image_* depth) {
  uint32_t dots[kHeight / kDot][kWidth / kDot];
  uint32_t random = 12345;
  for (int row = 0; row < kHeight / kDot; ++row) {
    for (int column = 0; column < kWidth / kDot; ++column) {
      random = random * 1664525u + 1013904223u;
      dots[row][column] = random >> 24;
    }
  }
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const int at = row * kWidth + column;
      memset(color->data._buffer + 3 * at, (int)dots[row / kDot][column / kDot], 3);
      const uint16_t millimetres = 2000;
      memcpy(depth->data._buffer + 2 * at, &millimetres, sizeof millimetres);
    }
  }
}

static sensor_msgs_msg_dds__CameraInfo_ camera_info(void) {
  sensor_msgs_msg_dds__CameraInfo_ info = {.width = kWidth, .height = kHeight, .distortion_model = "plumb_bob"};
  const double k[9] = {250, 0, 159.5, 0, 250, 119.5, 0, 0, 1};
  const double r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double p[12] = {250, 0, 159.5, 0, 0, 250, 119.5, 0, 0, 0, 1, 0};
  memcpy(info.k, k, sizeof k);
  memcpy(info.r, r, sizeof r);
  memcpy(info.p, p, sizeof p);
  return info;
}

static void publish_mount(dds_entity_t participant) {
  const dds_entity_t mounts = writer(participant, "rt/tf_static", &tf2_msgs_msg_dds__TFMessage__desc, true);
  geometry_msgs_msg_dds__TransformStamped_ mount = {.header = {.frame_id = "base_link"}};
  mount.child_frame_id = "camera_color_optical_frame";
  mount.transform.rotation = (geometry_msgs_msg_dds__Quaternion_){-0.5, 0.5, -0.5, 0.5};
  tf2_msgs_msg_dds__TFMessage_ message = {.transforms = {._length = 1, ._maximum = 1, ._buffer = &mount}};
  write_sample(mounts, &message);
}

int main(void) {
  signal(SIGTERM, stop);
  signal(SIGINT, stop);
  const char* domain = getenv("ROS_DOMAIN_ID");
  const dds_entity_t participant =
      checked(dds_create_participant(domain ? (dds_domainid_t)atoi(domain) : 0, NULL, NULL), "participant");
  publish_mount(participant);
  const dds_topic_descriptor_t* images = &sensor_msgs_msg_dds__Image__desc;
  const dds_topic_descriptor_t* infos = &sensor_msgs_msg_dds__CameraInfo__desc;
  const dds_entity_t colors = writer(participant, "rt/camera/color/image_raw", images, false);
  const dds_entity_t depths = writer(participant, "rt/camera/depth/image_raw", images, false);
  const dds_entity_t color_infos = writer(participant, "rt/camera/color/camera_info", infos, false);
  const dds_entity_t depth_infos = writer(participant, "rt/camera/depth/camera_info", infos, false);
  sensor_msgs_msg_dds__Image_ color = image_of("rgb8", 3), depth = image_of("16UC1", 2);
  draw_wall(&color, &depth);
  sensor_msgs_msg_dds__CameraInfo_ info = camera_info();
  for (dds_time_t due = dds_time(); !stopped; due += DDS_MSECS(100)) {
    color.header = depth.header = info.header = header_at(due);
    write_sample(color_infos, &info);
    write_sample(depth_infos, &info);
    write_sample(colors, &color);
    write_sample(depths, &depth);
    const dds_duration_t left = due + DDS_MSECS(100) - dds_time();
    if (left > 0) dds_sleepfor(left);
  }
  free(color.data._buffer);
  free(depth.data._buffer);
  return dds_delete(participant) == DDS_RETCODE_OK ? 0 : 1;
}
