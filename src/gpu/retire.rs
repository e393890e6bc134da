//! Holds dropped objects until the device no longer uses them.
//!
//! Every submission has a serial, which the queue's timeline semaphore reaches when the submission has finished. A
//! recording may use an object dropped meanwhile, so the object waits for the submission that ends the recording.

use std::collections::VecDeque;

use ash::vk;
use gpu_allocator::vulkan::{Allocation, Allocator};

/// An object to be destroyed.
pub(super) enum Retired {
    Buffer(vk::Buffer, Allocation),
    Image(vk::Image, Allocation, Vec<vk::ImageView>),
    Pipeline(vk::Pipeline),
    PipelineLayout(vk::PipelineLayout),
    SetLayout(vk::DescriptorSetLayout),
    DescriptorPool(vk::DescriptorPool),
    CommandPool(vk::CommandPool),
    QueryPool(vk::QueryPool),
    /// Anything else.
    Call(Box<dyn FnOnce(&ash::Device) + Send>),
}

#[derive(Default)]
pub(super) struct RetireQueue {
    /// Objects that wait for the submission that ends the present recording.
    recording: Vec<Retired>,
    /// Objects with the serial that must be reached, in rising order.
    waiting: VecDeque<(u64, Retired)>,
    /// Recordings that have begun and are neither submitted nor abandoned.
    open: u32,
}

impl RetireQueue {
    /// Adds an object that submissions up to `submitted` may use.
    pub fn push(&mut self, submitted: u64, object: Retired) {
        if self.open > 0 {
            self.recording.push(object);
        } else {
            self.waiting.push_back((submitted, object));
        }
    }

    pub fn recording_begun(&mut self) {
        self.open += 1;
    }

    /// Ends the last recording, which was submitted as `submitted` or abandoned.
    pub fn recording_ended(&mut self, submitted: u64) {
        self.open = self.open.saturating_sub(1);
        if self.open == 0 {
            self.waiting.extend(self.recording.drain(..).map(|object| (submitted, object)));
        }
    }

    /// Removes one object that is unused once the device has reached `serial`.
    pub fn take(&mut self, serial: u64) -> Option<Retired> {
        let (needed, _) = self.waiting.front()?;
        if *needed > serial {
            return None;
        }
        self.waiting.pop_front().map(|(_, object)| object)
    }

    /// Removes any object: the device is idle and about to be destroyed.
    pub fn take_any(&mut self) -> Option<Retired> {
        self.recording.pop().or_else(|| self.waiting.pop_front().map(|(_, object)| object))
    }

    /// Returns the number of waiting objects.
    pub fn len(&self) -> usize {
        self.recording.len() + self.waiting.len()
    }
}

impl Retired {
    pub fn destroy(self, device: &ash::Device, allocator: &mut Allocator) {
        // SAFETY: the handles were made by `device`, their owners are gone, and the device has
        // finished every submission that could name them.
        unsafe {
            match self {
                Retired::Buffer(buffer, memory) => {
                    device.destroy_buffer(buffer, None);
                    free(allocator, memory);
                }
                Retired::Image(image, memory, views) => {
                    for view in views {
                        device.destroy_image_view(view, None);
                    }
                    device.destroy_image(image, None);
                    free(allocator, memory);
                }
                Retired::Pipeline(pipeline) => device.destroy_pipeline(pipeline, None),
                Retired::PipelineLayout(layout) => device.destroy_pipeline_layout(layout, None),
                Retired::SetLayout(layout) => device.destroy_descriptor_set_layout(layout, None),
                Retired::DescriptorPool(pool) => device.destroy_descriptor_pool(pool, None),
                Retired::CommandPool(pool) => device.destroy_command_pool(pool, None),
                Retired::QueryPool(pool) => device.destroy_query_pool(pool, None),
                Retired::Call(destroy) => destroy(device),
            }
        }
    }
}

fn free(allocator: &mut Allocator, memory: Allocation) {
    if let Err(error) = allocator.free(memory) {
        tracing::error!("could not give device memory back: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object() -> Retired {
        Retired::Call(Box::new(|_| ()))
    }

    #[test]
    fn objects_wait_for_the_submission_that_may_use_them() {
        let mut queue = RetireQueue::default();
        queue.push(3, object());
        assert!(queue.take(2).is_none());
        assert!(queue.take(3).is_some());

        queue.recording_begun();
        queue.push(3, object());
        assert!(queue.take(3).is_none(), "the recording may name it");
        queue.recording_begun();
        queue.recording_ended(4);
        assert!(queue.take(4).is_none(), "another recording is still open");
        queue.recording_ended(5);
        assert!(queue.take(4).is_none());
        assert!(queue.take(5).is_some());
        assert_eq!(queue.len(), 0);
    }
}
