; A bag of blood is wanted in theatre 2, and medicine on the children's ward.
(define (problem hospital_tonight)
  (:domain hospital)
  (:objects
    basement blood_bank dispensary first_floor second_floor - spot
    theatre_1 theatre_2 childrens_ward maternity_ward - ward
    north_lift south_lift - lift
    blood medicine linen - cargo)
  (:init
    (robot-at basement) (dock basement)
    (corridor basement blood_bank) (corridor blood_bank basement)
    (corridor basement dispensary) (corridor dispensary basement)
    (corridor first_floor theatre_1) (corridor theatre_1 first_floor)
    (corridor first_floor theatre_2) (corridor theatre_2 first_floor)
    (corridor second_floor childrens_ward) (corridor childrens_ward second_floor)
    (corridor second_floor maternity_ward) (corridor maternity_ward second_floor)
    (stops-at north_lift basement) (stops-at north_lift first_floor)
    (stops-at north_lift second_floor)
    (stops-at south_lift basement) (stops-at south_lift first_floor)
    (stops-at south_lift second_floor)
    (running north_lift) (running south_lift)
    (waits blood blood_bank) (waits medicine dispensary) (waits linen basement))
  (:goal (and (brought blood theatre_2) (brought medicine childrens_ward) (docked))))
