; BROKEN     Twin of 05h_slower_turn_is_admitted.smt2: the other rate is greater.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const x Real)        ; robot's own way to rest
(declare-const eps Real)      ; reaction time
(declare-const omega Real)    ; turn rate
(declare-const omega1 Real)   ; another turn rate
(declare-const alpha Real)    ; turn acceleration
; Formulas
(define-fun turn_need ((omega Real)) Real (+ (* kappa (+ s x)) (* V (+ age eps (/ omega alpha)))))

; Assumptions
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= x 0))
(assert (> eps 0))
(assert (>= omega 0))
(assert (>= omega1 0))
(assert (> alpha 0))
(assert (<= (turn_need omega) d))
(assert (>= omega1 omega))                                   ; BROKEN: turned round

; Conclusion, negated
(assert (not (<= (turn_need omega1) d)))
(check-sat)
